//! Fur shows the colours it is asked for; what came with the program is what the program finds.

use super::fibre::fibres;
use furrier::math::DVec3;
use furrier::math::hash::Stream;
use furrier::preset::Preset;
use furrier::shade::Angles;
use furrier::shade::fibre::sample::Sampler;
use furrier::shade::fibre::{Fibre, FibreModel, FibreParameters};
use furrier::shade::law::known::{Known, known, scattering};
use furrier::shade::law::slab::{Slab, Stand};
use furrier::shade::law::{Colouring, Law, Place, Scattering, of_colour, solve};

/// What thick fur of a fibre shows where it wears colours, the lightest first.
fn shown(look: &Scattering, colours: [f64; 8]) -> [f64; 8] {
    let absorptions = colours.map(|colour| look.colouring.worn::<f64>(colour).absorption);
    Slab::new(&look.fibre, &Sampler::new(&look.fibre), absorptions).albedo(&Stand::new(37.0, 10.0), 40_000)
}

#[test]
fn fur_shows_the_colour_that_it_wears() {
    let colours = [0.8, 0.7, 0.55, 0.35, 0.2, 0.1, 0.06, 0.03];
    // The hair between, and hair without a medulla, which is the hardest to tell.
    for name in ["fox", "sheep"] {
        let fibres = Preset::load(name).unwrap().fibre;
        let found = shown(&scattering(fibres.model, &fibres.guard).unwrap(), colours);
        for (colour, shown) in colours.into_iter().zip(found) {
            println!("{name}, {colour}: shows {shown:.4}, {:+.1} %", 100.0 * (shown / colour - 1.0));
        }
        for (colour, shown) in colours.into_iter().zip(found) {
            assert!((shown / colour - 1.0).abs() < 0.05, "{name}: {colour} shows {shown}");
        }
    }
}

/// Of light that crosses a hair twice, a lighter colour lets through as much as a darker one, but for a thousandth.
#[test]
fn lighter_hair_absorbs_less() {
    for known in known().unwrap() {
        let colouring = known.scattering.colouring;
        let (mut most, mut logit) = (0.0_f64, f64::NEG_INFINITY);
        for i in 0..=400 {
            let worn = colouring.worn(f64::from(i) / 400.0);
            let through = (-4.0 * worn.absorption).exp();
            assert!(through > most - 1e-3 && worn.logit >= logit, "{worn:?} of {:?}", known.parameters);
            (most, logit) = (most.max(through), worn.logit);
        }
        assert!(most > 0.98, "{:?} lets through {most} at most", known.parameters);
    }
}

#[test]
fn fibres_of_built_in_presets_are_known() {
    let known = known().unwrap();
    for (name, parameters) in fibres() {
        assert!(known.iter().any(|known| known.is(FibreModel::Medulla, &parameters)), "{name} is not known");
    }
    for model in [FibreModel::Sadeghi, FibreModel::KajiyaKay] {
        assert!(known.iter().any(|known| known.is(model, &FibreParameters::default())), "{model:?} is not known");
    }
    for (i, one) in known.iter().enumerate() {
        assert!(known[..i].iter().all(|other| !other.is(one.model, &one.parameters)), "{one:?} is known twice");
    }
}

/// The largest relative difference between numbers of two fibres, over the largest in each group of them.
fn apart(a: &Fibre, b: &Fibre) -> f32 {
    let numbers = |fibre: &Fibre| bytemuck::bytes_of(fibre).to_vec();
    let (a, b): (Vec<f32>, Vec<f32>) =
        (bytemuck::pod_collect_to_vec(&numbers(a)), bytemuck::pod_collect_to_vec(&numbers(b)));
    let most = |values: &[f32]| values.iter().fold(1e-3_f32, |most, x| most.max(x.abs()));
    a.chunks(12)
        .zip(b.chunks(12))
        .fold(0.0_f32, |worst, (a, b)| a.iter().zip(b).fold(worst, |worst, (x, y)| worst.max((x - y).abs() / most(a))))
}

#[test]
fn known_fibres_are_what_their_parameters_say() {
    for Known { model, parameters, scattering } in known().unwrap() {
        let apart = apart(&scattering.fibre, &Fibre::new(model, &parameters));
        assert!(apart < 1e-4, "{model:?} {parameters:?} is known as another fibre, {apart} apart");
    }
}

/// Of two laws for one fibre's colours, by how much the second sends more in the mean of places that are seen, by light and colour.
pub fn apart_in_the_mean(colouring: &Colouring, one: &Law, other: &Law) -> Vec<(String, f64)> {
    let mut stream = Stream::new(29);
    let mut unit = || f64::from(stream.unit());
    let colours = [0.05, 0.2, 0.5, 0.8];
    let (mut light, mut sky) = ([[0.0; 2]; 4], [[0.0; 2]; 4]);
    for _ in 0..4000 {
        // Hair leans in x-z, light and eye over the horizon.
        let lean = 1.2 * unit();
        let hair = DVec3::new(libm::sin(lean), 0.0, libm::cos(lean));
        let mut over = || {
            let (z, turn) = (0.1 + 0.9 * unit(), std::f64::consts::TAU * unit());
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * libm::cos(turn), r * libm::sin(turn), z)
        };
        let (to_light, to_eye) = (over(), over());
        let above = 4.0 * unit() * unit();
        let angles = Angles::of_dvectors(hair, to_light, to_eye);
        let depth = above * angles.cos_in() / to_light.z;
        let place = Place::new(angles, to_light.dot(to_eye), above, depth, [hair.z, to_eye.z, to_light.z]);
        for (i, &colour) in colours.iter().enumerate() {
            let logit = colouring.worn::<f64>(colour).logit;
            for (j, law) in [one, other].into_iter().enumerate() {
                light[i][j] += of_colour(law.multiple(&place), logit, 0.0);
                sky[i][j] += of_colour(law.sky(&place), logit, 0.0);
            }
        }
    }
    let of = |what: &'static str, sums: [[f64; 2]; 4]| {
        let told =
            move |(colour, [one, other]): (f64, [f64; 2])| (format!("{what}, colour {colour}"), other / one - 1.0);
        colours.into_iter().zip(sums).map(told)
    };
    of("light", light).chain(of("sky", sky)).collect()
}

#[test]
fn the_default_fibre_is_solved_as_it_is_known() {
    let known = scattering(FibreModel::Medulla, &FibreParameters::default()).unwrap();
    let sampler = Sampler::new(&known.fibre);
    let law = solve::law(&known.fibre, &sampler, &known.colouring, 60_000);
    for (what, apart) in apart_in_the_mean(&known.colouring, &known.law, &law) {
        println!("{what}: {:+.2} %", 100.0 * apart);
        assert!(apart.abs() < 0.03, "{what}: {apart}");
    }
}
