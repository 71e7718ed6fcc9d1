//! What each source file of the library imports, read from its text: `use` declarations and paths within code, tests
//! included, comments and strings not.

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Segments of a path from the crate's root, as in `accel::node`.
pub(crate) type ModulePath = Vec<String>;

/// A word, `::` or any other character, and its line, from 1.
type Token = (String, usize);

/// An item of this crate that a file names.
#[derive(Clone, Debug)]
pub(crate) struct Import {
    /// From the crate's root; the last segment may be `*`.
    pub(crate) path: ModulePath,
    pub(crate) line: usize,
    /// The name that a `use` declaration binds it to, and whether the declaration is public.
    pub(crate) bound: Option<(String, bool)>,
}

/// A source file of the library.
#[derive(Clone, Debug)]
pub(crate) struct SourceFile {
    /// As in `src/accel/node.rs`.
    pub(crate) name: String,
    pub(crate) imports: Vec<Import>,
    /// Words outside `use` declarations.
    pub(crate) words: BTreeSet<String>,
}

/// All source files by their modules; `src/lib.rs` is the empty path.
pub(crate) type Crate = BTreeMap<ModulePath, SourceFile>;

pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Reads all files under `src/` but `main.rs`.
pub(crate) fn read_crate() -> Crate {
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
pub(crate) fn parse(
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
