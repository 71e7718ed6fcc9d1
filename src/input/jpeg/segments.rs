//! The marker segments of a JPEG file and the entropy-coded data between them (ITU-T T.81, annex B).

/// A file that is read from its first to its last byte.
#[derive(Debug)]
pub(super) struct Segments<'a> {
    rest: &'a [u8],
    /// How many bytes belonged to nothing.
    pub(super) extraneous: usize,
}

impl<'a> Segments<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Segments<'a> {
        Segments {
            rest: bytes,
            extraneous: 0,
        }
    }

    /// The next marker; none at the end of the file.
    pub(super) fn marker(&mut self) -> Option<u8> {
        loop {
            let before = self.next_ff();
            self.extraneous += before.len();
            let fill = self.rest.iter().take_while(|&&byte| byte == 0xff).count();
            let marker = *self.rest.get(fill)?;
            self.rest = &self.rest[fill + 1..];
            if marker != 0 {
                return Some(marker);
            }
            self.extraneous += fill + 1;
        }
    }

    /// The content of the segment that the last marker begins; none if the file ends within it.
    pub(super) fn content(&mut self) -> Option<&'a [u8]> {
        let (length, _) = self.rest.split_first_chunk()?;
        let length = usize::from(u16::from_be_bytes(*length));
        let content = self.rest.get(2..length)?;
        self.rest = &self.rest[length..];
        Some(content)
    }

    /// The data up to the next marker or the end of the file, without stuffed bytes.
    pub(super) fn entropy_coded(&mut self) -> Vec<u8> {
        let mut data = Vec::new();
        loop {
            data.extend(self.next_ff());
            let fill = self.rest.iter().take_while(|&&byte| byte == 0xff).count();
            if self.rest.get(fill) != Some(&0) {
                return data;
            }
            data.push(0xff);
            self.rest = &self.rest[fill + 1..];
        }
    }

    /// Everything before the next 0xff, which is then the next byte.
    fn next_ff(&mut self) -> &'a [u8] {
        let length = self.rest.iter().position(|&byte| byte == 0xff);
        let (before, rest) = self.rest.split_at(length.unwrap_or(self.rest.len()));
        self.rest = rest;
        before
    }
}

/// Appends a segment. Its content is shorter than 65,534 bytes.
pub(super) fn write_segment(bytes: &mut Vec<u8>, marker: u8, content: &[u8]) {
    let length = u16::try_from(content.len() + 2).expect("segments are written of a few tables");
    bytes.extend([0xff, marker]);
    bytes.extend(length.to_be_bytes());
    bytes.extend(content);
}

/// Appends entropy-coded data.
pub(super) fn write_entropy_coded(bytes: &mut Vec<u8>, data: &[u8]) {
    for &byte in data {
        bytes.push(byte);
        if byte == 0xff {
            bytes.push(0);
        }
    }
}
