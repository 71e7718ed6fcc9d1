//! Huffman codes of JPEG files, and the bits that they are read from (ITU-T T.81, annexes C and F).

/// Bytes behind the data of a [`Bits`], so that 57 bits can be looked at from each of its positions.
const PADDING: usize = 8;

/// The lengths and values of the codes, as files define them.
#[derive(Debug, Clone)]
pub(super) struct Codes {
    /// How many codes have 1 to 16 bits.
    counts: [u8; 16],
    /// Their values, by increasing length.
    values: Vec<u8>,
}

impl Codes {
    /// The codes at the beginning of `bytes` and what follows them, unless `bytes` ends within them or there are more
    /// codes than there are values, or than their lengths have.
    pub(super) fn parse(bytes: &[u8]) -> Option<(Codes, &[u8])> {
        let (&counts, bytes) = bytes.split_first_chunk::<16>()?;
        let count = counts.iter().copied().map(usize::from).sum();
        let (values, bytes) = bytes.split_at_checked(count)?;
        if count > 256 {
            return None;
        }
        let mut free = 1_i32;
        for count in counts {
            free = 2 * free - i32::from(count);
            // No code may consist of ones alone.
            if free < 1 {
                return None;
            }
        }
        let values = values.to_vec();
        Some((Codes { counts, values }, bytes))
    }

    /// Whether all values are numbers of bits.
    pub(super) fn are_sizes(&self) -> bool {
        self.values.iter().all(|&value| value < 16)
    }

    /// The codes as a file defines them.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        [&self.counts[..], &self.values].concat()
    }

    pub(super) fn table(&self) -> Table {
        let mut entries = vec![(0, 0); 1 << 16];
        let mut values = self.values.iter();
        let mut first = 0;
        for (length, &count) in (1..).zip(&self.counts) {
            for &value in values.by_ref().take(count.into()) {
                let next = first + (1 << (16 - length));
                entries[first..next].fill((length, value));
                first = next;
            }
        }
        Table { entries }
    }
}

/// The codes by the 16 bits that a code begins: its length, 0 where there is no code, and its value.
#[derive(Debug)]
pub(super) struct Table {
    entries: Vec<(u8, u8)>,
}

/// What ends the reading of entropy-coded data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fault {
    /// The data ends before what it should hold.
    Short,
    /// It holds what no encoder writes.
    Wrong,
}

/// Entropy-coded data without stuffed bytes, read bit by bit.
#[derive(Debug)]
pub(super) struct Bits {
    bytes: Vec<u8>,
    position: usize,
}

impl Bits {
    pub(super) fn new(mut bytes: Vec<u8>) -> Bits {
        bytes.extend([0; PADDING]);
        Bits { bytes, position: 0 }
    }

    fn bytes(&self) -> &[u8] {
        &self.bytes[..self.bytes.len() - PADDING]
    }

    /// At least the next 57 bits, from the highest on; zeros behind the data.
    fn peek(&self) -> u64 {
        let byte = self.position / 8;
        let (next, _) = self.bytes[byte..]
            .split_first_chunk()
            .expect("the position is not behind the data, and padding follows it");
        u64::from_be_bytes(*next) << (self.position % 8)
    }

    pub(super) fn skip(&mut self, bits: u32) -> Result<(), Fault> {
        let position = self.position + bits as usize;
        if position > 8 * self.bytes().len() {
            return Err(Fault::Short);
        }
        self.position = position;
        Ok(())
    }

    /// An unsigned number of 0 to 16 bits.
    pub(super) fn number(&mut self, bits: u32) -> Result<u32, Fault> {
        let number = (self.peek() >> 32 >> (32 - bits)) as u32;
        self.skip(bits)?;
        Ok(number)
    }

    pub(super) fn value(&mut self, table: &Table) -> Result<u8, Fault> {
        let (length, value) = table.entries[(self.peek() >> 48) as usize];
        if length == 0 {
            // Behind the data are zeros, with which a valid code may go on.
            let left = 8 * self.bytes().len() - self.position;
            return Err(if left < 16 {
                Fault::Short
            } else {
                Fault::Wrong
            });
        }
        self.skip(length.into())?;
        Ok(value)
    }

    /// The data up to the byte that was read last.
    pub(super) fn read(&self) -> &[u8] {
        &self.bytes[..self.position.div_ceil(8)]
    }

    /// How many bytes follow that one.
    pub(super) fn unread_bytes(&self) -> usize {
        self.bytes().len() - self.read().len()
    }

    /// Whether that byte is filled up with ones, as behind the last code of the data.
    pub(super) fn is_at_end(&self) -> bool {
        let used = self.position % 8;
        used == 0
            || self
                .read()
                .last()
                .is_some_and(|byte| byte << used == 0xff << used)
    }
}
