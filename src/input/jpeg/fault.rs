//! Why a JPEG file is refused.

/// What is wrong with a file.
#[derive(Debug)]
pub(in super::super) enum Fault {
    /// Pixels of it are lost, or it cannot be decoded: a message says why and what to do.
    Refused(String),
    /// It has more texels than are allowed.
    Large {
        /// Its columns.
        width: u32,
        /// Its rows.
        height: u32,
    },
}

pub(super) fn damaged(what: &str) -> Fault {
    Fault::Refused(format!(
        "{what}: the file is damaged or cut short; copy or save it again"
    ))
}

pub(super) fn unsupported(what: &str) -> Fault {
    Fault::Refused(format!(
        "{what} is not supported; save it as a baseline JPEG or a PNG file"
    ))
}
