//! Eight lanes by AVX2. No fused multiply-add: it rounds differently.
#![allow(unsafe_code, reason = "vector instructions, reached only through a proof that the machine has them")]

use super::{Isa, MOST, Row, Work};
use std::arch::x86_64::{
    __m256, __m256i, _CMP_LT_OQ, _MM_HINT_T0, _mm_prefetch, _mm256_add_epi32, _mm256_add_ps, _mm256_and_ps,
    _mm256_and_si256, _mm256_andnot_ps, _mm256_blendv_ps, _mm256_castps_si256, _mm256_castsi256_ps, _mm256_cmp_ps,
    _mm256_cmpeq_epi32, _mm256_cvtepi32_ps, _mm256_div_ps, _mm256_floor_ps, _mm256_i32gather_ps, _mm256_load_ps,
    _mm256_max_ps, _mm256_min_epu32, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_mullo_epi32,
    _mm256_or_si256, _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32, _mm256_slli_epi32,
    _mm256_sqrt_ps, _mm256_srai_epi32, _mm256_srli_epi32, _mm256_store_ps, _mm256_storeu_si256, _mm256_sub_ps,
    _mm256_xor_si256,
};

/// Eight lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Avx2(());

impl Avx2 {
    /// The proof that this machine has AVX2 and what goes with it, if it does.
    pub fn found() -> Option<Self> {
        use std::arch::is_x86_feature_detected as has;
        (has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt")).then_some(Self(()))
    }

    /// Runs work with it.
    pub fn run<W: Work>(self, work: W) -> W::Output {
        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
        fn with_avx2<W: Work>(work: W) -> W::Output {
            work.run::<Avx2>()
        }
        // SAFETY: a value of this type is only made where the machine has all of these.
        unsafe { with_avx2(work) }
    }
}

/// Asks memory for what will be read soon.
#[inline(always)]
pub fn prefetch<T>(of: &T) {
    // SAFETY: a hint, which every machine of this kind has, about memory that may be read.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(of).cast()) }
}

/// Calls one instruction of AVX2.
macro_rules! vector {
    ($call:expr) => {
        // SAFETY: this module's parent names `Avx2` nowhere but in `Avx2::run`, which holds the proof that the machine has
        // it; loads and stores go through references to aligned rows.
        unsafe { $call }
    };
}

impl Isa for Avx2 {
    const LANES: usize = 8;
    type F = __m256;
    type U = __m256i;
    type M = __m256;

    #[inline(always)]
    fn splat(x: f32) -> __m256 {
        vector!(_mm256_set1_ps(x))
    }
    #[inline(always)]
    fn load(row: &Row) -> __m256 {
        vector!(_mm256_load_ps(row.0.as_ptr()))
    }
    #[inline(always)]
    fn store(f: __m256) -> Row {
        let mut row = Row::default();
        vector!(_mm256_store_ps(row.0.as_mut_ptr(), f));
        row
    }
    #[inline(always)]
    fn add(a: __m256, b: __m256) -> __m256 {
        vector!(_mm256_add_ps(a, b))
    }
    #[inline(always)]
    fn sub(a: __m256, b: __m256) -> __m256 {
        vector!(_mm256_sub_ps(a, b))
    }
    #[inline(always)]
    fn mul(a: __m256, b: __m256) -> __m256 {
        vector!(_mm256_mul_ps(a, b))
    }
    #[inline(always)]
    fn div(a: __m256, b: __m256) -> __m256 {
        vector!(_mm256_div_ps(a, b))
    }
    #[inline(always)]
    fn min(a: __m256, b: __m256) -> __m256 {
        vector!(_mm256_min_ps(a, b))
    }
    #[inline(always)]
    fn max(a: __m256, b: __m256) -> __m256 {
        vector!(_mm256_max_ps(a, b))
    }
    #[inline(always)]
    fn sqrt(f: __m256) -> __m256 {
        vector!(_mm256_sqrt_ps(f))
    }
    #[inline(always)]
    fn floor(f: __m256) -> __m256 {
        vector!(_mm256_floor_ps(f))
    }
    #[inline(always)]
    fn lt(a: __m256, b: __m256) -> __m256 {
        vector!(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b))
    }
    #[inline(always)]
    fn select(m: __m256, yes: __m256, no: __m256) -> __m256 {
        vector!(_mm256_blendv_ps(no, yes, m))
    }
    #[inline(always)]
    fn both(a: __m256, b: __m256) -> __m256 {
        vector!(_mm256_and_ps(a, b))
    }
    #[inline(always)]
    fn not(m: __m256) -> __m256 {
        vector!(_mm256_andnot_ps(m, _mm256_castsi256_ps(_mm256_set1_epi32(-1))))
    }
    #[inline(always)]
    fn mask_bits(m: __m256) -> u32 {
        vector!(_mm256_movemask_ps(m)) as u32
    }
    #[inline(always)]
    fn pick(row: &Row, at: __m256i) -> __m256 {
        vector!(_mm256_permutevar8x32_ps(_mm256_load_ps(row.0.as_ptr()), at))
    }
    #[inline(always)]
    fn gather(table: &[f32], at: __m256i) -> __m256 {
        let Some(last) = table.len().checked_sub(1) else { return Self::splat(0.0) };
        let last = last.min(i32::MAX as usize) as i32;
        // No index leads past the table's last number.
        vector!(_mm256_i32gather_ps::<4>(table.as_ptr(), _mm256_min_epu32(at, _mm256_set1_epi32(last))))
    }
    #[inline(always)]
    fn of_whole(all: [u32; MOST]) -> __m256i {
        let [a, b, c, d, e, f, g, h] = all.map(|x| x as i32);
        vector!(_mm256_setr_epi32(a, b, c, d, e, f, g, h))
    }
    #[inline(always)]
    fn mask_from_bits(bits: u32) -> __m256 {
        vector!({
            let lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let own = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lanes);
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(own, lanes))
        })
    }
    #[inline(always)]
    fn to_bits(f: __m256) -> __m256i {
        vector!(_mm256_castps_si256(f))
    }
    #[inline(always)]
    fn from_bits(u: __m256i) -> __m256 {
        vector!(_mm256_castsi256_ps(u))
    }
    #[inline(always)]
    fn splat_whole(x: u32) -> __m256i {
        vector!(_mm256_set1_epi32(x as i32))
    }
    #[inline(always)]
    fn store_whole(u: __m256i) -> [u32; MOST] {
        let mut all = [0; MOST];
        vector!(_mm256_storeu_si256(all.as_mut_ptr().cast(), u));
        all
    }
    #[inline(always)]
    fn add_whole(a: __m256i, b: __m256i) -> __m256i {
        vector!(_mm256_add_epi32(a, b))
    }
    #[inline(always)]
    fn mul_whole(a: __m256i, b: __m256i) -> __m256i {
        vector!(_mm256_mullo_epi32(a, b))
    }
    #[inline(always)]
    fn and(a: __m256i, b: __m256i) -> __m256i {
        vector!(_mm256_and_si256(a, b))
    }
    #[inline(always)]
    fn or(a: __m256i, b: __m256i) -> __m256i {
        vector!(_mm256_or_si256(a, b))
    }
    #[inline(always)]
    fn xor(a: __m256i, b: __m256i) -> __m256i {
        vector!(_mm256_xor_si256(a, b))
    }
    #[inline(always)]
    fn shl<const N: i32>(u: __m256i) -> __m256i {
        vector!(_mm256_slli_epi32::<N>(u))
    }
    #[inline(always)]
    fn shr<const N: i32>(u: __m256i) -> __m256i {
        vector!(_mm256_srli_epi32::<N>(u))
    }
    #[inline(always)]
    fn sar<const N: i32>(u: __m256i) -> __m256i {
        vector!(_mm256_srai_epi32::<N>(u))
    }
    #[inline(always)]
    fn signed_to_f(u: __m256i) -> __m256 {
        vector!(_mm256_cvtepi32_ps(u))
    }
}
