//! Counts of what a file asks for and does not get.

use std::collections::BTreeMap;
use std::path::Path;

/// Counts of unsupported statements of a file, by kind.
#[derive(Default)]
pub(super) struct Unused(BTreeMap<String, usize>);

/// The most kinds that a warning names: a file that is no OBJ or MTL file may have any number.
const MAX_NAMED: usize = 8;

impl Unused {
    pub(super) fn add(&mut self, what: &str) {
        *self.0.entry(what.to_owned()).or_default() += 1;
    }

    /// The warning about `file`, if anything was counted.
    pub(super) fn warning(&self, file: &Path) -> Option<String> {
        let named = self.0.iter().take(MAX_NAMED);
        let mut named: Vec<String> = named.map(|(what, n)| format!("{n} {what}")).collect();
        if self.0.len() > MAX_NAMED {
            named.push(format!("{} other kinds", self.0.len() - MAX_NAMED));
        }
        let list = named.join(", ");
        (!list.is_empty()).then(|| format!("{}: not used: {list}", file.display()))
    }
}
