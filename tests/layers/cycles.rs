//! Source files that import each other in cycles.

use crate::imports::{Crate, Import, ModulePath, SourceFile, parse};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The files that import each other in cycles, with the lines of the imports.
pub(crate) fn cycles(files: &Crate) -> String {
    let edges: BTreeMap<&ModulePath, BTreeMap<&ModulePath, usize>> = files
        .keys()
        .map(|module| (module, edges(files, module)))
        .collect();
    let reached = |from: &ModulePath| {
        let mut reached = BTreeSet::new();
        let mut next: Vec<_> = edges[from].keys().copied().collect();
        while let Some(module) = next.pop() {
            if reached.insert(module) {
                next.extend(edges[module].keys());
            }
        }
        reached
    };
    let reached: BTreeMap<_, _> = files
        .keys()
        .map(|module| (module, reached(module)))
        .collect();
    let mut listed = BTreeSet::new();
    let mut text = String::new();
    for module in files
        .keys()
        .filter(|&module| reached[module].contains(module))
    {
        let is_in = |other: &&ModulePath| {
            reached[module].contains(other) && reached[*other].contains(module)
        };
        if listed.contains(module) {
            continue;
        }
        text.push_str("cycle:\n");
        for member in files.keys().filter(is_in) {
            listed.insert(member);
            for (to, line) in edges[member].iter().filter(|(to, _)| is_in(to)) {
                let (from, to) = (&files[member].name, &files[*to].name);
                writeln!(text, "  {from}:{line} -> {to}").expect("a string can be written to");
            }
        }
    }
    text
}

/// The files that the file of `module` depends on, each with the first line of an import. Names that a parent only
/// re-exports from its children do not count.
fn edges<'a>(files: &'a Crate, module: &ModulePath) -> BTreeMap<&'a ModulePath, usize> {
    let file = &files[module];
    let mut edges = BTreeMap::new();
    for Import { path, line, bound } in &file.imports {
        let is_reexport = bound
            .as_ref()
            .is_some_and(|(name, is_public)| *is_public && !file.words.contains(name));
        if is_reexport && path.starts_with(module) {
            continue;
        }
        let mut found = BTreeSet::new();
        origins(files, path, 0, &mut found);
        found.remove(module);
        for other in found {
            edges.entry(other).or_insert(*line);
        }
    }
    edges
}

/// The files that define what `path` names, which is followed through the `use` declarations of its modules.
fn origins<'a>(
    files: &'a Crate,
    path: &[String],
    depth: usize,
    found: &mut BTreeSet<&'a ModulePath>,
) {
    let longest = (0..=path.len())
        .rev()
        .find_map(|n| files.get_key_value(&path[..n]));
    let (module, file) = longest.expect("the root is a file");
    let (name, rest) = match &path[module.len()..] {
        [] => ("", &[][..]),
        [name, rest @ ..] => (&name[..], rest),
    };
    let mut is_reexported = false;
    for import in file.imports.iter().filter(|_| depth < 8) {
        if import
            .bound
            .as_ref()
            .is_some_and(|(bound, is_public)| bound == name || (name == "*" && *is_public))
        {
            is_reexported = true;
            origins(files, &[&import.path[..], rest].concat(), depth + 1, found);
        }
    }
    if !is_reexported || name == "*" {
        found.insert(module);
    }
}

#[test]
fn cycles_are_found_through_reexports() {
    let file = |module: &str, text: &str, children: &[&str]| {
        let module: ModulePath = module.split("::").map(str::to_owned).collect();
        let children = children
            .iter()
            .map(|c| [&module[..], &[(*c).to_owned()]].concat());
        let (imports, words) = parse(text, &module, &children.collect());
        let name = module.join("/");
        (
            module,
            SourceFile {
                name,
                imports,
                words,
            },
        )
    };
    let parent = file(
        "m",
        "mod a; mod b; pub use a::A; pub use b::B; pub struct M;",
        &["a", "b"],
    );
    let a = file("m::a", "use super::{B, M}; pub struct A;", &[]);
    let acyclic = file("m::b", "use super::M; pub struct B;", &[]);
    let cyclic = file("m::b", "use super::A; pub struct B;", &[]);
    let files = |b| Crate::from([parent.clone(), a.clone(), b]);
    assert_eq!(cycles(&files(acyclic)), "");
    let found = cycles(&files(cyclic));
    assert_eq!(found, "cycle:\n  m/a:1 -> m/b\n  m/b:1 -> m/a\n");
}
