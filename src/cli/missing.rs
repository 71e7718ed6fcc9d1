use super::args::MissingArguments;
use super::frames::ranges;
use super::values::ListFormatArgument;
use super::verify::verify;
use super::{Failure, Status};
use crate::frames::FrameFolder;
use std::io::Write;

pub(super) fn run(arguments: &MissingArguments) -> Result<Status, Failure> {
    let folder = FrameFolder::open(&arguments.folder)?;
    let frames: Vec<u32> = (0..folder.sequence().frames).collect();
    let proofs = verify(&folder, &frames, arguments.quiet).into_iter();
    let missing = proofs.filter_map(|(frame, proof)| proof.is_err().then_some(frame));
    let listed = match arguments.format {
        ListFormatArgument::List => missing.map(|frame| format!("{frame}\n")).collect(),
        ListFormatArgument::Openjd => line(missing.collect()),
        ListFormatArgument::Slurm => {
            let mut tasks: Vec<u32> = missing.map(|frame| frame / arguments.chunk).collect();
            tasks.dedup();
            line(tasks)
        }
    };
    write!(std::io::stdout(), "{listed}")?;
    Ok(Status::Done)
}

/// Ranges and a line's end; nothing of nothing.
fn line(numbers: Vec<u32>) -> String {
    match numbers.is_empty() {
        true => String::new(),
        false => ranges(&numbers) + "\n",
    }
}
