//! Numbers side by side against the same numbers one by one.

use furrier::fur::groom::Colour;
use furrier::fur::groom::clump::Nearby;
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::undercoat::{Pattern, Undercoat};
use furrier::math::Vec3;
use furrier::math::hash::Stream;
use furrier::math::lanes::{self, F32s, Isa, Row, Scalar, U32s, Vec3Row, Vec3s, Work};
use furrier::math::noise::simplex_lanes;
use furrier::volume::shell::block::{code, codes};

/// A function of lanes over many numbers.
struct Over<'a, F> {
    values: &'a [f32],
    function: F,
}

/// What can be asked of lanes without naming how many there are.
#[derive(Clone, Copy)]
enum Function {
    Exp,
    Log2,
    Pow(f32),
    Acos,
    Cos,
    Whole,
}

impl Work for Over<'_, Function> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Vec<f32> {
        let mut out = Vec::new();
        for some in self.values.chunks(I::LANES) {
            let mut row = Row::default();
            row.0[..some.len()].copy_from_slice(some);
            let x = F32s::<I>::of(&row);
            let y = match self.function {
                Function::Exp => x.exp_negative(),
                Function::Log2 => x.log2(),
                Function::Pow(power) => x.pow_unit(F32s::splat(power)),
                Function::Acos => x.acos(),
                Function::Cos => x.cos(),
                Function::Whole => x.to_whole().signed_to_f32(),
            };
            out.extend(&y.row().0[..some.len()]);
        }
        out
    }
}

/// Numbers of a table by index.
struct Gather<'a> {
    table: &'a [f32],
    at: &'a [u32],
}

impl Work for Gather<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Vec<f32> {
        let all = |some: &[u32]| U32s::<I>::each(|lane| some.get(lane).copied().unwrap_or(0)).gather(self.table).row();
        self.at.chunks(I::LANES).flat_map(|some| all(some).0[..some.len()].to_vec()).collect()
    }
}

#[test]
fn what_lies_past_a_tables_end_is_its_last_number() {
    let table: Vec<f32> = (0..11).map(|i| i as f32 + 0.5).collect();
    let at = [0, 10, 3, 11, 1 << 20, u32::MAX, 1 << 31, 7, 5];
    let expected: Vec<f32> = at.iter().map(|&i| table[(i as usize).min(10)]).collect();
    assert_eq!(lanes::run(Gather { table: &table, at: &at }), expected);
    assert_eq!(Gather { table: &table, at: &at }.run::<Scalar>(), expected);
    assert_eq!(lanes::run(Gather { table: &[], at: &at }), vec![0.0; at.len()]);
}

fn values(low: f32, high: f32) -> Vec<f32> {
    let mut random = Stream::new(7);
    (0..4001).map(|_| low + (high - low) * random.unit()).chain([low, high]).collect()
}

/// Largest difference to `truth`, by the same bits on the widest lanes and on one.
fn worst(function: Function, range: [f32; 2], truth: impl Fn(f64) -> f64) -> f64 {
    let values = values(range[0], range[1]);
    let wide = lanes::run(Over { values: &values, function });
    let single = Over { values: &values, function }.run::<Scalar>();
    assert!(wide.iter().zip(&single).all(|(a, b)| a.to_bits() == b.to_bits()), "lanes do not change results");
    let difference = |(&x, &y): (&f32, &f32)| (f64::from(y) - truth(f64::from(x))).abs();
    values.iter().zip(&wide).map(difference).fold(0.0, f64::max)
}

#[test]
fn functions_are_within_a_few_units_of_the_last_place() {
    assert!(worst(Function::Exp, [-20.0, 0.0], libm::exp) < 3e-7);
    assert!(worst(Function::Log2, [1e-3, 8.0], libm::log2) < 2e-6);
    assert!(worst(Function::Pow(8.0), [0.0, 1.0], |x| libm::pow(x, 8.0)) < 2e-6);
    assert!(worst(Function::Acos, [-1.0, 1.0], libm::acos) < 2e-6);
    assert!(worst(Function::Cos, [-3.2, 3.2], libm::cos) < 2e-6);
    assert_eq!(worst(Function::Whole, [0.0, 8e6], libm::floor), 0.0);
    assert!(worst(Function::Exp, [-20.0, 0.0], |x| libm::exp(x * 1.000_01)) > 3e-7, "a planted fault is seen");
}

#[test]
fn what_is_no_number_becomes_the_lower_bound() {
    let clamp = F32s::<Scalar>::splat(f32::NAN).within(0.25, 1.0);
    assert_eq!(clamp.row().0[0], 0.25);
}

/// Noise at many points.
struct Noise<'a>(&'a [Vec3]);

impl Work for Noise<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Vec<f32> {
        let mut out = Vec::new();
        for some in self.0.chunks(I::LANES) {
            let mut row = Vec3Row::default();
            some.iter().enumerate().for_each(|(lane, &p)| row.set(lane, p));
            out.extend(&simplex_lanes(Vec3s::<I>::of(&row), 3, None).row().0[..some.len()]);
        }
        out
    }
}

/// Simplex noise at one place, as the papers have it: [`simplex_lanes`] has the same bits.
pub fn simplex(p: Vec3, seed: u32) -> f32 {
    let skewed = p + (p.x + p.y + p.z) * (1.0 / 3.0);
    let cell = skewed.floor();
    let x0 = p - (cell - (cell.x + cell.y + cell.z) * (1.0 / 6.0));
    // The two middle corners of the tetrahedron that holds the point, by the order of its coordinates.
    let ge = |a: f32, b: f32| f32::from(u8::from(a >= b));
    let (xy, yz, zx) = (ge(x0.x, x0.y), ge(x0.y, x0.z), ge(x0.z, x0.x));
    let rank = Vec3::new(xy + (1.0 - zx), (1.0 - xy) + yz, (1.0 - yz) + zx);
    let first = Vec3::new(ge(rank.x, 2.0), ge(rank.y, 2.0), ge(rank.z, 2.0));
    let second = Vec3::new(ge(rank.x, 1.0), ge(rank.y, 1.0), ge(rank.z, 1.0));
    let corners = [(Vec3::ZERO, 0.0), (first, 1.0 / 6.0), (second, 1.0 / 3.0), (Vec3::ONE, 0.5)];
    let mut sum = 0.0;
    for (corner, unskew) in corners {
        let d = x0 - corner + unskew;
        let fall = 0.6 - d.length_squared();
        if fall > 0.0 {
            sum += fall * fall * fall * fall * d.dot(gradient(cell + corner, seed));
        }
    }
    32.0 * sum
}

/// One of the twelve edge directions of a cube.
fn gradient(corner: Vec3, seed: u32) -> Vec3 {
    let mut h = seed;
    for c in corner.to_array() {
        h = (h ^ (c as i32 as u32)).wrapping_mul(0x9E37_79B1);
        h ^= h >> 15;
    }
    h = h.wrapping_mul(0x85EB_CA77);
    let sign = |bit: u32| if h >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let (u, v) = (sign(31), sign(30));
    match (h >> 8) % 3 {
        0 => Vec3::new(u, v, 0.0),
        1 => Vec3::new(u, 0.0, v),
        _ => Vec3::new(0.0, u, v),
    }
}

#[test]
fn noise_in_lanes_has_the_bits_of_noise() {
    let mut random = Stream::new(11);
    let mut coordinate = || 2000.0 * (random.unit() - 0.5);
    let points: Vec<Vec3> = (0..20_000).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect();
    for (values, name) in [(lanes::run(Noise(&points)), "widest"), (Noise(&points).run::<Scalar>(), "one")] {
        for (&p, value) in points.iter().zip(values) {
            assert_eq!(value.to_bits(), simplex(p, 3).to_bits(), "{name} lane(s), at {p}");
        }
    }
}

/// Crowding at half height over many points, and its codes.
struct Crowding<'a> {
    undercoat: &'a Undercoat,
    roots_m: &'a [Vec3],
}

impl Work for Crowding<'_> {
    type Output = (Vec<f32>, Vec<u8>);

    #[inline(always)]
    fn run<I: Isa>(self) -> Self::Output {
        let (mut crowding, mut bytes) = (Vec::new(), Vec::new());
        let mut nearby = Nearby::default();
        for some in self.roots_m.chunks(I::LANES) {
            let mut row = Vec3Row::default();
            some.iter().enumerate().for_each(|(lane, &p)| row.set(lane, p));
            let (root_m, normal) = (Vec3s::<I>::of(&row), Vec3s::splat(Vec3::Y));
            let columns = self.undercoat.columns(&mut nearby, root_m, normal, F32s::splat(0.9));
            let values = columns.crowdings(F32s::splat(0.5));
            crowding.extend(&values.row().0[..some.len()]);
            bytes.extend(codes(values).row()[..some.len()].iter().map(|&code| code as u8));
        }
        (crowding, bytes)
    }
}

#[test]
fn columns_side_by_side_crowd_as_one_does() {
    let fibre = Fibre::undercoat(&crate::scenes::mink().1, &Colour::default(), 0.5);
    let mut undercoat = Undercoat::new(&fibre, Some(Pattern::default()));
    (undercoat.clump_strength, undercoat.clump_spacing_m) = (0.8, 2e-3);
    let mut random = Stream::new(13);
    // Points of one cell and of its neighbours lie side by side.
    let mut coordinate = || 3.0 * undercoat.clump_spacing_m * (random.unit() - 0.5);
    let roots_m: Vec<Vec3> = (0..4096).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect();
    let (crowding, bytes) = lanes::run(Crowding { undercoat: &undercoat, roots_m: &roots_m });
    let alone = |root_m: &Vec3| undercoat.column(*root_m, Vec3::Y, 0.9).crowding(0.5);
    let truth: Vec<f32> = roots_m.iter().map(alone).collect();
    assert!(crowding.iter().zip(&truth).all(|(a, b)| a.to_bits() == b.to_bits()));
    assert!(truth.contains(&0.0) && truth.iter().any(|&c| c > 1.2), "clumps leave gaps between them");
    assert!(bytes.iter().zip(&truth).all(|(&byte, &value)| byte == code(value)));
}
