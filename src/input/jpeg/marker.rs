//! The markers of JPEG files, before each of which stands the byte 0xff (ITU-T T.81, annex B.1.1.3).

pub(super) const SEQUENTIAL: u8 = 0xc0;
pub(super) const EXTENDED_SEQUENTIAL: u8 = 0xc1;
pub(super) const PROGRESSIVE: u8 = 0xc2;
pub(super) const HUFFMAN_TABLES: u8 = 0xc4;
pub(super) const ARITHMETIC_CONDITIONING: u8 = 0xcc;
pub(super) const RESTART_0: u8 = 0xd0;
pub(super) const RESTART_7: u8 = 0xd7;
pub(super) const START_OF_IMAGE: u8 = 0xd8;
pub(super) const END_OF_IMAGE: u8 = 0xd9;
pub(super) const START_OF_SCAN: u8 = 0xda;
pub(super) const QUANTIZATION_TABLES: u8 = 0xdb;
pub(super) const NUMBER_OF_LINES: u8 = 0xdc;
pub(super) const RESTART_INTERVAL: u8 = 0xdd;
pub(super) const APPLICATION_0: u8 = 0xe0;
pub(super) const APPLICATION_14: u8 = 0xee;
pub(super) const APPLICATION_15: u8 = 0xef;
pub(super) const COMMENT: u8 = 0xfe;
pub(super) const TEMPORARY: u8 = 0x01;
