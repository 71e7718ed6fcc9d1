//! Faults during a batch: processes that are killed, full disks, folders that vanish. No finished frame is lost, no
//! partial file has a frame's name, and the exit status says whether to try again.

mod batch;
mod disks;
mod injected;
mod memory;
mod mutations;
mod others;
mod planted;
mod processes;
mod proof;
mod signals;
