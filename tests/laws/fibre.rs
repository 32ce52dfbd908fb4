//! A hair under uniform light sends back what it was given and no more; light's path can be reversed; nothing jumps.

use crate::scenes;
use furrier::math::hash::Stream;
use furrier::math::lanes::{self, F32s, Isa, Row, Scalar, Work};
use furrier::math::{DVec3, Vec3};
use furrier::preset::Preset;
use furrier::shade::fibre::sample::Sampler;
use furrier::shade::fibre::{Fibre, FibreModel, FibreParameters};
use furrier::shade::law::{Place, Scattering};
use furrier::shade::{Angles, Real};
use std::f64::consts::PI;

/// Share of uniform light that a fibre without colour sends back to an eye at inclination `theta_out`.
pub fn sent(fibre: &Fibre, theta_out: f64) -> f64 {
    furnace(theta_out, |angles| fibre.lit(angles).through(0.0))
}

/// ∫ S cos θ_i dω_i over the sphere for an eye at inclination `theta_out`.
fn furnace(theta_out: f64, scatter: impl Fn(Angles<f64>) -> f64) -> f64 {
    let (rows, columns) = (360, 72);
    let sin_out = theta_out.sin();
    let mut sum = 0.0;
    for row in 0..rows {
        let theta_in = PI * ((f64::from(row) + 0.5) / f64::from(rows) - 0.5);
        // Both sides are alike.
        for column in 0..columns {
            let azimuth = PI * (f64::from(column) + 0.5) / f64::from(columns);
            let angles = Angles { sin_in: theta_in.sin(), sin_out, cos_azimuth: azimuth.cos() };
            sum += scatter(angles) * theta_in.cos() * theta_in.cos();
        }
    }
    sum * (PI / f64::from(rows)) * (2.0 * PI / f64::from(columns))
}

/// Up to 89°.
fn eyes() -> impl Iterator<Item = f64> {
    [-89.0, -85.0].into_iter().chain((-8..=8).map(|i| f64::from(i) * 10.0)).chain([85.0, 89.0]).map(f64::to_radians)
}

/// The farthest that what a fibre sends back is from its albedo, over it.
pub fn departure(fibre: &Fibre, albedo: f64) -> f64 {
    eyes().map(|eye| (sent(fibre, eye) / albedo - 1.0).abs()).fold(0.0, f64::max)
}

/// The fibres of all built-in presets and the default one, each once.
pub fn fibres() -> Vec<(String, FibreParameters)> {
    let mut all = vec![("default".to_owned(), FibreParameters::default())];
    for name in Preset::names() {
        let fibres = Preset::load(name).unwrap().fibre;
        assert_eq!(fibres.model, FibreModel::Medulla, "{name}");
        for (kind, parameters) in [("guard", fibres.guard), ("undercoat", fibres.undercoat)] {
            if all.iter().all(|(_, own)| *own != parameters) {
                all.push((format!("{name}, {kind}"), parameters));
            }
        }
    }
    all
}

#[test]
fn hair_without_colour_sends_back_all_light_to_every_side() {
    for (name, parameters) in fibres() {
        let off = departure(&Fibre::new(FibreModel::Medulla, &parameters), 1.0);
        println!("{name}: within {off:.1e}");
        assert!(off < 5e-3, "{name} is off by {off}");
    }
}

#[test]
fn fibres_of_papers_send_back_their_albedo() {
    for (model, albedo) in [(FibreModel::Sadeghi, 0.9), (FibreModel::KajiyaKay, 0.95)] {
        let off = departure(&Fibre::new(model, &FibreParameters::default()), albedo);
        println!("{model:?}: within {off:.1e}");
        assert!(off < 5e-3, "{model:?} is off by {off}");
    }
}

#[test]
fn what_a_hair_sends_falls_with_its_absorption_and_never_below_nothing() {
    for (name, parameters) in fibres() {
        let fibre = Fibre::new(FibreModel::Medulla, &parameters);
        let mut stream = Stream::new(5);
        for _ in 0..3000 {
            let [sin_in, sin_out, cos_azimuth] = std::array::from_fn(|_| 2.0 * f64::from(stream.unit()) - 1.0);
            let lit = fibre.lit(Angles { sin_in, sin_out, cos_azimuth });
            let [none, some, all] = [0.0, 0.4, 1e9].map(|absorption| lit.through(absorption));
            assert!(none >= some && some >= all && all >= 0.0, "{name}: {none}, {some}, {all}");
        }
    }
}

#[test]
fn light_can_go_the_other_way() {
    let models = [FibreModel::Medulla, FibreModel::Sadeghi, FibreModel::KajiyaKay];
    for fibre in models.map(|model| Fibre::new(model, &FibreParameters::default())) {
        let mut stream = Stream::new(7);
        for _ in 0..2000 {
            let [a, b, c] = std::array::from_fn(|_| 2.0 * f64::from(stream.unit()) - 1.0);
            let there = fibre.lit(Angles { sin_in: a, sin_out: b, cos_azimuth: c });
            let back = fibre.lit(Angles { sin_in: b, sin_out: a, cos_azimuth: c });
            for absorption in [0.0, 0.3, 3.0] {
                let (x, y) = (there.through(absorption), back.through(absorption));
                assert!((x - y).abs() <= 1e-12 * x.max(1.0), "{x} there, {y} back");
            }
        }
    }
}

/// A hair of a coat: directions of hair, light, eye and normal, hair above, depth, crowding, colour.
#[derive(Clone, Copy, Debug)]
struct Case {
    directions: [Vec3; 4],
    above: f32,
    depth: f32,
    crowding: f32,
    colour: Vec3,
}

fn direction(stream: &mut Stream) -> Vec3 {
    loop {
        let v = Vec3::new(stream.unit(), stream.unit(), stream.unit()) * 2.0 - 1.0;
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

impl Case {
    fn random(stream: &mut Stream) -> Self {
        let directions = std::array::from_fn(|_| direction(stream));
        let above = 12.0 * stream.unit() * stream.unit();
        let depth = above * (4.0 * stream.unit() - 2.0).exp();
        let crowding = 0.05 * stream.unit();
        let colour = Vec3::new(stream.unit(), stream.unit(), stream.unit());
        Self { directions, above, depth, crowding, colour }
    }

    /// Cosines between the directions: hair with light, eye and normal; light with eye and normal; eye with normal.
    fn cosines(&self) -> [f64; 6] {
        let [hair, light, eye, normal] = self.directions.map(|v| v.as_dvec3().normalize());
        [hair.dot(light), hair.dot(eye), hair.dot(normal), light.dot(eye), light.dot(normal), eye.dot(normal)]
    }

    fn numbers(&self) -> [f64; 12] {
        let [a, b, c, d, e, f] = self.cosines();
        let Vec3 { x, y, z } = self.colour;
        let rest = [self.above, self.depth, self.crowding, x, y, z].map(f64::from);
        [a, b, c, d, e, f, rest[0], rest[1], rest[2], rest[3], rest[4], rest[5]]
    }

    fn lit(&self, look: &Scattering) -> [f64; 6] {
        lit(look, self.numbers())
    }
}

/// What is sent of a light, and of the sky.
#[inline(always)]
fn lit<R: Real>(look: &Scattering, numbers: [R; 12]) -> [R; 6] {
    let [hair_light, hair_eye, hair_normal, light_eye, light_normal, eye_normal, above, depth, crowding, x, y, z] =
        numbers;
    let angles = Angles::new(hair_light, hair_eye, light_eye);
    let place = Place::new(angles, light_eye, above, depth, [hair_normal, eye_normal, light_normal]);
    let worn = look.wear([x, y, z]);
    let [a, b, c] = look.light(angles, &place, &worn, crowding);
    let [d, e, f] = look.sky(&place, &worn, crowding);
    [a, b, c, d, e, f]
}

struct Many<'a> {
    look: &'a Scattering,
    cases: &'a [[f32; 12]],
}

impl Work for Many<'_> {
    type Output = Vec<[f32; 6]>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Self::Output {
        let mut out = Vec::new();
        for some in self.cases.chunks(I::LANES) {
            let mut numbers = [F32s::<I>::splat(0.0); 12];
            for (k, number) in numbers.iter_mut().enumerate() {
                let mut row = Row::default();
                some.iter().enumerate().for_each(|(lane, case)| row.0[lane] = case[k]);
                *number = F32s::of(&row);
            }
            let sent = lit(self.look, numbers).map(|sent| sent.row());
            out.extend((0..some.len()).map(|lane| sent.map(|row| row.0[lane])));
        }
        out
    }
}

/// The largest differences of what f32, alone and in lanes, gives for `single` to what f64 gives for `double`, over it and 1e-5:
/// anywhere; and where hair and light are nearly in line, or light stands right behind the hair, where |cos(φ/2)| has a kink and
/// cos φ is a quotient of roundings.
pub fn off(single: &Scattering, double: &Scattering) -> [f64; 2] {
    let mut stream = Stream::new(11);
    let cases: Vec<Case> = (0..4000).map(|_| Case::random(&mut stream)).collect();
    let numbers: Vec<[f32; 12]> = cases.iter().map(|case| case.numbers().map(|x| x as f32)).collect();
    let wide = lanes::run(Many { look: single, cases: &numbers });
    let one = Many { look: single, cases: &numbers }.run::<Scalar>();
    let mut most = [0.0_f64; 2];
    for (i, numbers) in numbers.iter().enumerate() {
        let exact = numbers.map(f64::from);
        let truth = lit(double, exact);
        let angles = Angles::new(exact[0], exact[1], exact[3]);
        let in_line = angles.sin_in.abs().max(angles.sin_out.abs()) > 0.999 || angles.cos_azimuth < -1.0 + 1e-5;
        assert!((0..6).all(|k| wide[i][k].to_bits() == one[i][k].to_bits()), "lanes do not change results");
        for found in [wide[i], lit(single, *numbers)] {
            for (found, truth) in found.into_iter().zip(truth) {
                let off = &mut most[usize::from(in_line)];
                *off = off.max((f64::from(found) - truth).abs() / (truth + 1e-5));
            }
        }
    }
    most
}

#[test]
fn single_precision_and_lanes_agree_with_double() {
    for look in crate::formulas::law::looks() {
        let [off, in_line] = off(&look, &look);
        println!("within {off:.1e}, in line {in_line:.1e}");
        assert!(off < 5e-3 && in_line < 3e-2, "{off}, in line {in_line}");
    }
    assert_eq!(f32::of(0.5).sqrt(), 0.5_f32.sqrt());
}

#[test]
fn whatever_stands_before_the_light_the_law_is_a_number() {
    let mut stream = Stream::new(17);
    let look = scenes::scattering().guard;
    let extremes = [0.0, 1e-6, 0.1, 16.0, 1e4];
    for _ in 0..40 {
        let own = Case::random(&mut stream);
        let [hair, light, eye, normal] = own.directions;
        let in_line = [
            [hair, hair, eye, normal],
            [hair, -hair, eye, normal],
            [hair, light, hair, normal],
            [hair, light, -hair, normal],
            [hair, eye, eye, normal],
            [hair, -eye, eye, normal],
            [hair, hair, hair, hair],
            [hair, light, eye, -light],
        ];
        for (directions, above) in in_line.into_iter().flat_map(|all| extremes.map(|above| (all, above))) {
            for (depth, colour) in extremes.into_iter().flat_map(|depth| [0.0, 1.0].map(|colour| (depth, colour))) {
                let case = Case { directions, above, depth, crowding: own.crowding, colour: Vec3::splat(colour) };
                let numbers = case.numbers();
                let single = lit(&look, numbers.map(|x| x as f32)).map(f64::from);
                let wide = lanes::run(Many { look: &look, cases: &[numbers.map(|x| x as f32)] })[0].map(f64::from);
                for sent in [lit(&look, numbers), single, wide].into_iter().flatten() {
                    assert!((0.0..10.0).contains(&sent), "{sent} of {case:?}");
                }
            }
        }
    }
}

/// The largest step of what is sent, over its largest value, along a path through cases.
fn jump(look: &Scattering, steps: usize, case: impl Fn(f64) -> Case) -> f64 {
    let sent: Vec<[f64; 6]> = (0..=steps).map(|i| case(i as f64 / steps as f64).lit(look)).collect();
    let most = sent.iter().flatten().fold(0.0_f64, |most, &x| most.max(x));
    let step = sent.windows(2).flat_map(|two| (0..6).map(move |k| (two[1][k] - two[0][k]).abs()));
    step.fold(0.0_f64, f64::max) / most
}

#[test]
fn nothing_jumps() {
    let mut stream = Stream::new(19);
    let look = scenes::scattering().guard;
    for _ in 0..12 {
        let own = Case::random(&mut stream);
        let [hair, light, eye, normal] = own.directions;
        // From a thousandth to ten thousand, a factor of 1.008 at a time.
        let decades = |x: f64| 1e-3 * 10.0_f64.powf(7.0 * x) as f32;
        let depths = jump(&look, 2000, |x| Case { depth: decades(x), ..own });
        let above = jump(&look, 2000, |x| Case { above: decades(x), ..own });
        let colours = jump(&look, 2000, |x| Case { colour: Vec3::splat(x as f32), ..own });
        // Light that passes through the hair's own direction, and the normal's horizon.
        let turned = |to: Vec3, x: f64| {
            let across = to.cross(light).normalize();
            let away = across.cross(to);
            let (sin, cos) = ((x - 0.5) * PI).sin_cos();
            to * cos as f32 + away * sin as f32
        };
        let along = jump(&look, 2000, |x| Case { directions: [hair, turned(hair, x), eye, normal], ..own });
        let over = jump(&look, 2000, |x| Case { directions: [hair, turned(normal, x), eye, normal], ..own });
        // And through the eye's.
        let past = jump(&look, 2000, |x| Case { directions: [hair, turned(eye, x), eye, normal], ..own });
        for (what, jump) in [
            ("depth", depths),
            ("hair above", above),
            ("colour", colours),
            ("light along the hair", along),
            ("light over the horizon", over),
            ("light past the eye", past),
        ] {
            assert!(jump < 0.02, "{what} makes light jump by {jump} at {own:?}");
        }
    }
}

#[test]
fn random_directions_are_drawn_with_the_density_they_claim() {
    for fibre in [FibreModel::Medulla, FibreModel::Sadeghi, FibreModel::KajiyaKay]
        .map(|model| Fibre::new(model, &FibreParameters::default()))
    {
        let sampler = Sampler::new(&fibre);
        let mut stream = Stream::new(23);
        for theta in [0.0, 0.6, -1.2] {
            let hair = DVec3::new(0.36, 0.48, 0.8);
            let across = hair.any_orthonormal_vector();
            let eye = hair * libm::sin(theta) + across * libm::cos(theta);
            let n = 60_000;
            let (mut albedo, mut sphere, mut square) = (0.0, 0.0, 0.0);
            for _ in 0..n {
                let random = std::array::from_fn(|_| f64::from(stream.unit()));
                let (to_light, density) = sampler.sample(hair, eye, 0.0, random);
                let angles = Angles::of_dvectors(hair, to_light, eye);
                albedo += fibre.lit(angles).through(0.0) * angles.cos_in() / density / f64::from(n);
                sphere += 1.0 / density / f64::from(n);
                square += 1.0 / (density * density) / f64::from(n);
                let again = sampler.density(hair, eye, to_light, 0.0);
                assert!((again / density - 1.0).abs() < 1e-9, "{again} and {density}");
            }
            let noise = ((square - sphere * sphere) / f64::from(n)).sqrt();
            let sent = sent(&fibre, theta);
            println!("{albedo:.4} of {sent:.4}, {sphere:.3} ± {noise:.3} of {:.3}", 4.0 * PI);
            assert!((albedo / sent - 1.0).abs() < 0.01, "{albedo} of {sent}");
            assert!((sphere - 4.0 * PI).abs() < 4.0 * noise && noise < 0.6, "{sphere} ± {noise}");
        }
    }
}
