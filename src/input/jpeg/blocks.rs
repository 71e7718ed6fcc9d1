//! Reads entropy-coded blocks without decoding their samples, which proves that all of them are there
//! (ITU-T T.81, annexes F and G).

use super::huffman::{Bits, Fault, Table};

/// The coefficients of a block, in zigzag order.
const COEFFICIENTS: u32 = 64;

/// Differences of 8-bit samples' DC coefficients have at most so many bits.
const MAX_DC_BITS: u8 = 11;

/// What a scan holds of each block.
#[derive(Debug, Clone, Copy)]
pub(super) enum Coding {
    /// All coefficients.
    Sequential,
    /// The DC coefficient.
    DcFirst,
    /// Another bit of it.
    DcRefinement,
    /// AC coefficients from this one to this one.
    AcFirst([u32; 2]),
    /// Another bit of them.
    AcRefinement([u32; 2]),
}

/// A component's tables in a scan; those that its coding needs are there.
#[derive(Debug, Default)]
pub(super) struct Tables {
    pub(super) dc: Option<Table>,
    pub(super) ac: Option<Table>,
}

/// Reads a block. `nonzero` is which coefficients of it are not zero, for progressive AC scans. `end_of_band_run` is
/// for how many more blocks of the interval no new coefficient comes.
pub(super) fn read_block(
    bits: &mut Bits,
    coding: Coding,
    tables: &Tables,
    nonzero: &mut u64,
    end_of_band_run: &mut u32,
) -> Result<(), Fault> {
    match coding {
        Coding::Sequential => {
            read_dc(bits, needed(&tables.dc))?;
            read_ac(bits, needed(&tables.ac))
        }
        Coding::DcFirst => read_dc(bits, needed(&tables.dc)),
        Coding::DcRefinement => bits.skip(1),
        Coding::AcFirst([first, last]) => {
            let band = Band {
                first,
                last,
                nonzero,
            };
            band.read(bits, needed(&tables.ac), end_of_band_run)
        }
        Coding::AcRefinement([first, last]) => {
            let band = Band {
                first,
                last,
                nonzero,
            };
            band.refine(bits, needed(&tables.ac), end_of_band_run)
        }
    }
}

fn needed(table: &Option<Table>) -> &Table {
    table
        .as_ref()
        .expect("a scan is read with the tables that its coding needs")
}

fn read_dc(bits: &mut Bits, table: &Table) -> Result<(), Fault> {
    match bits.value(table)? {
        size @ 0..=MAX_DC_BITS => bits.skip(size.into()),
        _ => Err(Fault::Wrong),
    }
}

/// A run of zeros, from the high half of a value, and the size of the coefficient behind it, from the low half.
fn run_and_size(value: u8) -> (u32, u32) {
    (u32::from(value >> 4), u32::from(value & 15))
}

fn read_ac(bits: &mut Bits, table: &Table) -> Result<(), Fault> {
    let mut index = 1;
    while index < COEFFICIENTS {
        match run_and_size(bits.value(table)?) {
            (15, 0) => index += 16,
            (_, 0) => return Ok(()),
            (run, size) => {
                bits.skip(size)?;
                index += run + 1;
            }
        }
    }
    if index == COEFFICIENTS {
        Ok(())
    } else {
        Err(Fault::Wrong)
    }
}

/// Progressively coded AC coefficients of one block.
struct Band<'a> {
    first: u32,
    last: u32,
    nonzero: &'a mut u64,
}

impl Band<'_> {
    fn read(self, bits: &mut Bits, table: &Table, end_of_band_run: &mut u32) -> Result<(), Fault> {
        if *end_of_band_run > 0 {
            *end_of_band_run -= 1;
            return Ok(());
        }
        let mut index = self.first;
        while index <= self.last {
            match run_and_size(bits.value(table)?) {
                (15, 0) => index += 16,
                (run, 0) => {
                    *end_of_band_run = (1 << run) + bits.number(run)? - 1;
                    return Ok(());
                }
                (run, size) => {
                    bits.skip(size)?;
                    index += run;
                    if index > self.last {
                        return Err(Fault::Wrong);
                    }
                    *self.nonzero |= 1 << index;
                    index += 1;
                }
            }
        }
        if index == self.last + 1 {
            Ok(())
        } else {
            Err(Fault::Wrong)
        }
    }

    /// Coefficients that are not zero have a bit each, those that no longer are zero a code.
    fn refine(
        self,
        bits: &mut Bits,
        table: &Table,
        end_of_band_run: &mut u32,
    ) -> Result<(), Fault> {
        let mut index = self.first;
        while *end_of_band_run == 0 && index <= self.last {
            let (run, size) = run_and_size(bits.value(table)?);
            match (run, size) {
                (15, 0) => {}
                (_, 0) => {
                    *end_of_band_run = (1 << run) + bits.number(run)?;
                    break;
                }
                (_, 1) => bits.skip(1)?,
                _ => return Err(Fault::Wrong),
            }
            let mut zeros = run;
            while index <= self.last {
                if *self.nonzero >> index & 1 == 1 {
                    bits.skip(1)?;
                } else if zeros == 0 {
                    break;
                } else {
                    zeros -= 1;
                }
                index += 1;
            }
            if index > self.last {
                return Err(Fault::Wrong);
            }
            *self.nonzero |= u64::from(size) << index;
            index += 1;
        }
        if *end_of_band_run > 0 {
            *end_of_band_run -= 1;
            let rest = (u64::MAX >> (63 - self.last)) & (u64::MAX << index);
            bits.skip((*self.nonzero & rest).count_ones())?;
        }
        Ok(())
    }
}
