//! `selftest`: the table of numerically hard cases.

use super::outcome::{Failure, Status};
use crate::selftest::CASES;
use crate::simd::Kernel;
use rayon::prelude::*;
use std::io::Write;
use std::sync::mpsc;

/// Runs the cases side by side, and prints them in their order as soon as they are known.
pub(super) fn run() -> Result<Status, Failure> {
    let (send, receive) = mpsc::channel();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            let cases = CASES.par_iter().enumerate();
            // The receiver is gone if the output cannot be written.
            cases.try_for_each_with(send, |send, (number, case)| {
                send.send((number, case.run())).ok()
            })
        });
        print(receive.into_iter())
    })
}

fn print(found: impl Iterator<Item = (usize, Vec<f64>)>) -> Result<Status, Failure> {
    let mut out = std::io::stdout();
    write!(out, "{:45} {:34} {:>7}", "case", "measured", "limit")?;
    for kernel in Kernel::available() {
        write!(out, " {kernel:>9}")?;
    }
    writeln!(out)?;
    let mut waiting: Vec<Option<Vec<f64>>> = vec![None; CASES.len()];
    let mut next = 0;
    let mut failures = 0;
    for (number, worst) in found {
        waiting[number] = Some(worst);
        while let Some(worst) = waiting.get_mut(next).and_then(Option::take) {
            let case = &CASES[next];
            if next == 0 || case.group != CASES[next - 1].group {
                writeln!(out, "{}", case.group)?;
            }
            let limit = short(case.limit);
            write!(out, "  {:43} {:34} {limit:>7}", case.name, case.measures)?;
            for value in &worst {
                write!(out, " {:>9}", short(*value))?;
            }
            let holds = case.holds(&worst);
            writeln!(out, "  {}", if holds { "ok" } else { "FAILED" })?;
            failures += usize::from(!holds);
            next += 1;
        }
    }
    let count = CASES.len();
    if failures == 0 {
        writeln!(out, "all {count} cases hold")?;
        return Ok(Status::Done);
    }
    writeln!(
        out,
        "{failures} of {count} cases FAILED: pictures of this machine or build are not to be trusted"
    )?;
    Ok(Status::SelfTestFailed)
}

/// Counts as they are, other numbers with two digits.
fn short(value: f64) -> String {
    if value.fract() == 0.0 {
        value.to_string()
    } else {
        format!("{value:.1e}")
    }
}
