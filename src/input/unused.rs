use std::collections::BTreeMap;
use std::path::Path;

/// Counts what a file asks for and does not get.
#[derive(Default)]
pub(super) struct Unused(BTreeMap<String, usize>);

/// So many kinds are named: a file that is not what its name says may have any number.
const NAMED: usize = 8;

impl Unused {
    pub(super) fn add(&mut self, what: &str) {
        *self.0.entry(what.to_owned()).or_default() += 1;
    }

    /// What to tell the user of it, if there is anything.
    pub(super) fn warning(&self, file: &Path) -> Option<String> {
        let named = self.0.iter().take(NAMED);
        let mut named: Vec<String> = named.map(|(what, n)| format!("{n} {what}")).collect();
        if self.0.len() > NAMED {
            named.push(format!("{} other kinds", self.0.len() - NAMED));
        }
        let list = named.join(", ");
        (!list.is_empty()).then(|| format!("{}: not used: {list}", file.display()))
    }
}
