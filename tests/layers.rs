//! The modules of the crate import only from lower layers of the table in `src/lib.rs`, and source files have no
//! import cycles.
//!
//! Imports are read from the source text: `use` declarations and paths in code, that of tests included, but not those
//! in comments and strings.

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Segments of a path from the crate's root, as in `accel::node`.
type ModulePath = Vec<String>;

/// A word, `::` or any other character, and its line, from 1.
type Token = (String, usize);

/// An item of this crate that a file names.
#[derive(Clone, Debug)]
struct Import {
    /// From the crate's root; the last segment may be `*`.
    path: ModulePath,
    line: usize,
    /// The name that a `use` declaration binds it to, and whether the declaration is public.
    bound: Option<(String, bool)>,
}

/// A source file of the library.
#[derive(Clone, Debug)]
struct SourceFile {
    /// As in `src/accel/node.rs`.
    name: String,
    imports: Vec<Import>,
    /// Words outside `use` declarations.
    words: BTreeSet<String>,
}

/// All source files by their modules; `src/lib.rs` is the empty path.
type Crate = BTreeMap<ModulePath, SourceFile>;

#[test]
fn modules_import_only_from_lower_layers() {
    let layers = layers(&root_text());
    let mut violations = String::new();
    for (module, file) in &read_crate() {
        let Some(own) = module.first() else { continue };
        for Import { path, line, .. } in &file.imports {
            let name = &file.name;
            let (Some(layer), Some(other)) = (layers.get(own), layers.get(&path[0])) else {
                let path = path.join("::");
                writeln!(
                    violations,
                    "{name}:{line}: crate::{path} is of no module in the table"
                )
                .expect("a string can be written to");
                continue;
            };
            if path[0] != *own && other >= layer {
                let imported = &path[0];
                writeln!(
                    violations,
                    "{name}:{line}: `{own}` (layer {layer}) imports `{imported}` (layer {other})"
                )
                .expect("a string can be written to");
            }
        }
    }
    assert!(violations.is_empty(), "\n{violations}");
}

#[test]
fn the_table_of_layers_has_every_module_once() {
    let text = root_text();
    let declared = text
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod "));
    let declared: BTreeSet<String> = declared
        .map(|l| l.trim_end_matches(';').to_owned())
        .collect();
    let layers = layers(&text);
    assert_eq!(layers.keys().cloned().collect::<BTreeSet<_>>(), declared);
}

#[test]
fn no_files_import_each_other_in_a_cycle() {
    let cycles = cycles(&read_crate());
    assert!(cycles.is_empty(), "\n{cycles}");
}

#[test]
fn every_file_says_what_it_holds() {
    let mut without_doc = Vec::new();
    for file in read_crate().into_values() {
        let text = fs::read_to_string(root().join(&file.name)).expect("text");
        if !text.starts_with("//! ") {
            without_doc.push(file.name);
        }
    }
    assert!(
        without_doc.is_empty(),
        "no `//!` at the top: {without_doc:#?}"
    );
}

#[test]
fn every_form_of_import_is_found() {
    let text = r##"
        //! [`crate::comment`]
        use crate::{a::{self, B as C}, d::*};
        pub(crate) use child::Name;
        mod inline {
            use super::super::e; /* use crate::comment; */
            fn f<'a>(_: &'a crate::f::G) -> char { self::h::<u8>('"'); child::i("crate::string") }
        }
        const TEXT: &str = r#"crate::"raw""#;
        type T = ::child::Outer<std::k::L>;
    "##;
    let module = ["m".to_owned(), "n".to_owned()];
    let children = BTreeSet::from([[&module[..], &["child".to_owned()]].concat()]);
    let (imports, words) = parse(text, &module, &children);
    let found: Vec<_> = imports
        .iter()
        .map(|i| (i.path.join("::"), i.line))
        .collect();
    let expected = [
        ("a", 3),
        ("a::B", 3),
        ("d::*", 3),
        ("m::n::child::Name", 4),
        ("m::e", 6),
        ("f::G", 7),
        ("m::n::inline::h", 7),
        ("m::n::child::i", 7),
    ];
    assert_eq!(found, expected.map(|(path, line)| (path.to_owned(), line)));
    let bound = |i: usize| {
        imports[i]
            .bound
            .as_ref()
            .map(|(name, is_public)| (&name[..], *is_public))
    };
    assert_eq!(
        [bound(0), bound(1)],
        [Some(("a", false)), Some(("C", false))]
    );
    assert_eq!([bound(3), bound(5)], [Some(("Name", true)), None]);
    assert!(words.contains("TEXT") && !words.contains("Name"));
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

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn root_text() -> String {
    fs::read_to_string(root().join("src/lib.rs")).expect("a crate has a root")
}

/// The layer of every module in the table of the crate's documentation.
fn layers(text: &str) -> BTreeMap<String, u32> {
    let mut layers = BTreeMap::new();
    for row in text.lines().filter_map(|line| line.strip_prefix("//! | ")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let Ok(layer) = cells[0].parse() else {
            continue;
        };
        for module in cells[1].split(", ") {
            let module = module.trim_start_matches("[`").trim_end_matches("`]");
            let earlier = layers.insert(module.to_owned(), layer);
            assert_eq!(earlier, None, "`{module}` is in the table twice");
        }
    }
    layers
}

/// Reads all files under `src/` but `main.rs`.
fn read_crate() -> Crate {
    let mut texts = BTreeMap::new();
    let mut folders = vec![root().join("src")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path
                    .strip_prefix(root())
                    .expect("under the root")
                    .display()
                    .to_string();
                let module = name["src/".len()..]
                    .trim_end_matches(".rs")
                    .split('/')
                    .map(str::to_owned);
                let mut module: ModulePath = module.collect();
                module.pop_if(|last| matches!(&last[..], "mod" | "lib"));
                texts.insert(module, (name, fs::read_to_string(&path).expect("text")));
            }
        }
    }
    texts.remove(&["main".to_owned()][..]);
    let modules: BTreeSet<ModulePath> = texts.keys().cloned().collect();
    let files = texts.into_iter().map(|(module, (name, text))| {
        let (imports, words) = parse(&text, &module, &modules);
        (
            module,
            SourceFile {
                name,
                imports,
                words,
            },
        )
    });
    files.collect()
}

/// The imports of the file of `module`, and the words outside its `use` declarations. `modules` are all modules that
/// have a file.
fn parse(
    text: &str,
    module: &[String],
    modules: &BTreeSet<ModulePath>,
) -> (Vec<Import>, BTreeSet<String>) {
    let tokens = tokens(text);
    let at = |i: usize| tokens.get(i).map_or("", |(text, _)| &text[..]);
    let mut imports = Vec::new();
    let mut words = BTreeSet::new();
    // For every open brace the inline module that it begins, if any.
    let mut open: Vec<Option<String>> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let inline: ModulePath = open.iter().flatten().cloned().collect();
        let line = tokens[i].1;
        let mut import = |path: &[String], bound: Option<(String, bool)>| {
            let path = absolute(path, module, &inline, modules).filter(|path| !path.is_empty());
            imports.extend(path.map(|path| Import { path, line, bound }));
        };
        match at(i) {
            "{" => open.push((at(i.wrapping_sub(2)) == "mod").then(|| at(i - 1).to_owned())),
            "}" => drop(open.pop()),
            "use" if at(i + 1) != "<" => {
                let is_public = at(i.wrapping_sub(1)) == "pub" || at(i.wrapping_sub(1)) == ")";
                let mut leaves = Vec::new();
                let end = use_tree(&tokens, i + 1, &[], &mut leaves);
                for (path, name) in leaves {
                    import(&path, inline.is_empty().then_some((name, is_public)));
                }
                i = end;
                continue;
            }
            word if is_word(word) => {
                words.insert(word.to_owned());
                let mut path = vec![word.to_owned()];
                let starts = !matches!(at(i.wrapping_sub(1)), "::" | ".");
                while starts && at(i + 1) == "::" && is_word(at(i + 2)) {
                    i += 2;
                    words.insert(at(i).to_owned());
                    path.push(at(i).to_owned());
                }
                if path.len() > 1 {
                    import(&path, None);
                }
            }
            _ => {}
        }
        i += 1;
    }
    (imports, words)
}

/// Collects the leaves of a `use` tree from token `i` on, each with the name it is bound to. Returns the token after
/// the tree.
fn use_tree(
    tokens: &[Token],
    mut i: usize,
    before: &[String],
    leaves: &mut Vec<(ModulePath, String)>,
) -> usize {
    let mut path = before.to_vec();
    while let Some((text, _)) = tokens.get(i) {
        match &text[..] {
            "{" => {
                i += 1;
                while tokens[i].0 != "}" {
                    let end = use_tree(tokens, i, &path, leaves);
                    assert!(end > i, "{:?} in a `use` declaration", tokens[i]);
                    i = end + usize::from(tokens[end].0 == ",");
                }
                return i + 1;
            }
            "::" if path.is_empty() => path.push("::".to_owned()),
            "::" => {}
            "as" => {
                leaves.push((path, tokens[i + 1].0.clone()));
                return i + 2;
            }
            "self" if !before.is_empty() => {}
            word if is_word(word) || word == "*" => path.push(word.to_owned()),
            _ => break,
        }
        i += 1;
    }
    let name = path.last().cloned().unwrap_or_default();
    leaves.push((path, name));
    i
}

/// The path from the crate's root of `path` in the module `inline` of the file of `module`; none if it names another
/// crate or an imported name.
fn absolute(
    path: &[String],
    module: &[String],
    inline: &[String],
    modules: &BTreeSet<ModulePath>,
) -> Option<ModulePath> {
    let here = [module, inline].concat();
    match &path[0][..] {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([&here, &path[1..]].concat()),
        "super" => {
            let parents = path
                .iter()
                .take_while(|segment| *segment == "super")
                .count();
            Some([&here[..here.len().checked_sub(parents)?], &path[parents..]].concat())
        }
        _ => {
            // A child of the file's module, which tests within the file see as well.
            let child = [module, &path[..1]].concat();
            (!module.is_empty() && modules.contains(&child)).then(|| [module, path].concat())
        }
    }
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphanumeric() || c == '_')
}

/// The tokens of Rust source text, without literals and comments.
fn tokens(text: &str) -> Vec<Token> {
    let stream: TokenStream = text.parse().expect("it compiles");
    let mut tokens = Vec::new();
    flatten(stream, &mut tokens);
    tokens
}

fn flatten(stream: TokenStream, tokens: &mut Vec<Token>) {
    let mut trees = stream.into_iter();
    while let Some(tree) = trees.next() {
        let line = tree.span().start().line;
        match tree {
            TokenTree::Group(group) => {
                let [open, close] = match group.delimiter() {
                    Delimiter::Brace => ["{", "}"],
                    Delimiter::Parenthesis => ["(", ")"],
                    Delimiter::Bracket => ["[", "]"],
                    Delimiter::None => ["", ""],
                };
                tokens.push((open.to_owned(), line));
                flatten(group.stream(), tokens);
                tokens.push((close.to_owned(), line));
            }
            TokenTree::Ident(word) => tokens.push((word.to_string(), line)),
            TokenTree::Punct(mark) if mark.as_char() == ':' && mark.spacing() == Spacing::Joint => {
                trees.next();
                tokens.push(("::".to_owned(), line));
            }
            // In macros `$crate` stands for `crate`.
            TokenTree::Punct(dollar) if dollar.as_char() == '$' => {}
            TokenTree::Punct(mark) => tokens.push((mark.to_string(), line)),
            TokenTree::Literal(_) => {}
        }
    }
}

/// The files that import each other in cycles, with the lines of the imports.
fn cycles(files: &Crate) -> String {
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
