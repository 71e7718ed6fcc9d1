//! The modules of the crate import only from lower layers of the table in `src/lib.rs`, and no source files
//! import each other in a cycle.

mod cycles;
mod imports;

use cycles::cycles;
use imports::{Import, read_crate, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;

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
