//! Every operation of every register, on special values, beside plain arrays.

#![expect(
    unsafe_code,
    reason = "calls into code compiled for a detected processor"
)]

use super::doubles::Doubles;
use super::floats::Floats;
use super::pair::Avx2FloatsPair;
use super::portable::{PortableDoubles, PortableFloats};
use super::x86_64::{Avx2Floats, Avx512Floats};
use super::x86_64_doubles::{Avx2Doubles, Avx512Doubles};
use super::{Kernel, Simd, WithSimd};

const SPECIAL: [f32; 12] = [
    0.0,
    -0.0,
    1.0,
    -1.5,
    1e-45,
    -1e-38,
    3.4e38,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    0.1,
    7.0,
];

/// Every operation whose bits are guaranteed.
#[inline(always)]
fn results<V: Floats<N>, const N: usize>(a: &[f32; N], b: &[f32; N]) -> ([[u32; N]; 11], [u32; 2]) {
    let (a, b) = (V::load(a), V::load(b));
    let bits = |v: V| {
        v.store()
            .map(|x| if x.is_nan() { 0x7fc0_0000 } else { x.to_bits() })
    };
    (
        [
            a.add(b),
            a.sub(b),
            a.mul(b),
            a.div(b),
            a.sqrt(),
            a.min(b),
            a.max(b),
            a.zero_below(0.5),
            b.zero_below(1e-40),
            a.copy_sign(b),
            a.select_le(b, b.sub(a), a),
        ]
        .map(bits),
        [a.lt(b), a.le(b)],
    )
}

/// Applies `check` to lanes of every pair of special values.
fn each_pair<const N: usize>(check: impl Fn(&[f32; N], &[f32; N])) {
    for shift in 0..SPECIAL.len() {
        for start in 0..SPECIAL.len() {
            let a = std::array::from_fn(|i| SPECIAL[(i + start) % SPECIAL.len()]);
            let b = std::array::from_fn(|i| SPECIAL[(i + start + shift) % SPECIAL.len()]);
            check(&a, &b);
        }
    }
}

#[target_feature(enable = "avx2,fma")]
fn with_avx2(a: &[f32; 8], b: &[f32; 8]) -> ([[u32; 8]; 11], [u32; 2]) {
    results::<Avx2Floats, 8>(a, b)
}

#[target_feature(enable = "avx2,fma")]
fn with_pair(a: &[f32; 16], b: &[f32; 16]) -> ([[u32; 16]; 11], [u32; 2]) {
    results::<Avx2FloatsPair, 16>(a, b)
}

#[target_feature(enable = "avx512f,avx512dq,avx512vl")]
fn with_avx512(a: &[f32; 16], b: &[f32; 16]) -> ([[u32; 16]; 11], [u32; 2]) {
    results::<Avx512Floats, 16>(a, b)
}

fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

#[test]
fn avx2_equals_portable_bit_for_bit() {
    if !has_avx2() {
        return;
    }
    each_pair(|a, b| {
        // SAFETY: AVX2 and FMA were detected above.
        let vector = unsafe { with_avx2(a, b) };
        assert_eq!(vector, results::<PortableFloats<8>, 8>(a, b));
    });
    each_pair(|a, b| {
        // SAFETY: AVX2 and FMA were detected above.
        let vector = unsafe { with_pair(a, b) };
        assert_eq!(vector, results::<PortableFloats<16>, 16>(a, b));
    });
}

#[test]
fn avx512_equals_portable_bit_for_bit() {
    if !has_avx512() {
        return;
    }
    each_pair(|a, b| {
        // SAFETY: AVX-512 was detected above.
        let vector = unsafe { with_avx512(a, b) };
        assert_eq!(vector, results::<PortableFloats<16>, 16>(a, b));
    });
}

/// Every operation of double precision, on single-precision lanes and on what they make.
#[inline(always)]
fn results_in_double<D: Doubles<8>>(a: &[f32; 8], b: &[f32; 8]) -> ([[u64; 8]; 9], [u32; 2]) {
    let widen = |lanes| D::widen(D::Floats::load(lanes));
    let (a, b) = (widen(a), widen(b));
    let third = a.mul(D::splat(1.0 / 3.0));
    let bits = |v: D| {
        v.store().map(|x| match x.is_nan() {
            true => f64::NAN.to_bits(),
            false => x.to_bits(),
        })
    };
    (
        [
            a,
            a.add(b),
            third.sub(b),
            third.mul(b),
            a.div(b),
            a.max(b),
            third,
            third.round_for_order(),
            D::load(&third.store()),
        ]
        .map(bits),
        [a.lt(b), a.le(b)],
    )
}

#[target_feature(enable = "avx2,fma")]
fn double_with_avx2(a: &[f32; 8], b: &[f32; 8]) -> ([[u64; 8]; 9], [u32; 2]) {
    results_in_double::<Avx2Doubles>(a, b)
}

#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn double_with_avx512(a: &[f32; 8], b: &[f32; 8]) -> ([[u64; 8]; 9], [u32; 2]) {
    results_in_double::<Avx512Doubles>(a, b)
}

#[test]
fn doubles_equal_portable_bit_for_bit() {
    each_pair(|a, b| {
        let expected = results_in_double::<PortableDoubles<8>>(a, b);
        if has_avx2() {
            // SAFETY: AVX2 and FMA were detected.
            assert_eq!(unsafe { double_with_avx2(a, b) }, expected);
        }
        if has_avx512() {
            // SAFETY: AVX-512, AVX2 and FMA were detected.
            assert_eq!(unsafe { double_with_avx512(a, b) }, expected);
        }
    });
}

#[test]
fn rounding_for_order_keeps_28_bits() {
    for t in [1.0, 1.0 + 2f64.powi(-28), 2.0 - 2f64.powi(-28), 0.0, 3e38] {
        for lost in [0.0, 2f64.powi(-29), 2f64.powi(-28) - 2f64.powi(-52)] {
            let [rounded, ..] = PortableDoubles::<8>::splat(t * (1.0 + lost))
                .round_for_order()
                .store();
            let error = t * (1.0 + lost) - rounded;
            assert!((0.0..2f64.powi(-28) * t.max(1e-300)).contains(&error));
        }
    }
}

/// The words of eight rows of eight, and two rows side by side.
struct Rearrange;

impl WithSimd for Rearrange {
    type Output = ([[f32; 8]; 8], [f32; 16]);

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> Self::Output {
        let row = |i: usize| S::F32x8::load(&std::array::from_fn(|k| (10 * i + k) as f32));
        let rows = [
            row(0),
            row(1),
            row(2),
            row(3),
            row(4),
            row(5),
            row(6),
            row(7),
        ];
        let columns = S::transpose(rows).map(|column| column.store());
        (columns, S::join(rows[3], rows[5]).store())
    }
}

#[test]
fn rows_become_columns_and_halves_wholes() {
    for kernel in Kernel::available() {
        let (columns, joined) = kernel.run(Rearrange);
        for (k, column) in columns.into_iter().enumerate() {
            assert_eq!(column, std::array::from_fn(|i| (10 * i + k) as f32));
        }
        let expected = std::array::from_fn(|i| [30, 50][i / 8] as f32 + (i % 8) as f32);
        assert_eq!(joined, expected, "{kernel}");
    }
}
