//! Every operation of every register, on special values, beside plain arrays.

#![expect(
    unsafe_code,
    reason = "calls into code compiled for a detected processor"
)]

use super::floats::Floats;
use super::pair::Avx2FloatsPair;
use super::portable::PortableFloats;
use super::x86_64::{Avx2Floats, Avx512Floats};

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
fn results<V: Floats<N>, const N: usize>(a: &[f32; N], b: &[f32; N]) -> ([[u32; N]; 9], [u32; 2]) {
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
fn with_avx2(a: &[f32; 8], b: &[f32; 8]) -> ([[u32; 8]; 9], [u32; 2]) {
    results::<Avx2Floats, 8>(a, b)
}

#[target_feature(enable = "avx2,fma")]
fn with_pair(a: &[f32; 16], b: &[f32; 16]) -> ([[u32; 16]; 9], [u32; 2]) {
    results::<Avx2FloatsPair, 16>(a, b)
}

#[target_feature(enable = "avx512f")]
fn with_avx512(a: &[f32; 16], b: &[f32; 16]) -> ([[u32; 16]; 9], [u32; 2]) {
    results::<Avx512Floats, 16>(a, b)
}

#[test]
fn avx2_equals_portable_bit_for_bit() {
    if !is_x86_feature_detected!("avx2") || !is_x86_feature_detected!("fma") {
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
    if !is_x86_feature_detected!("avx512f") {
        return;
    }
    each_pair(|a, b| {
        // SAFETY: AVX-512 F was detected above.
        let vector = unsafe { with_avx512(a, b) };
        assert_eq!(vector, results::<PortableFloats<16>, 16>(a, b));
    });
}
