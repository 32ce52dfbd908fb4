//! Wet hair is dry hair of a darker colour, with a smoother surface.

use super::colour::apart_in_the_mean;
use furrier::preset::Preset;
use furrier::shade::fibre::sample::Sampler;
use furrier::shade::fibre::{Fibre, FibreModel, FibreParameters, Film};
use furrier::shade::law::known::{known, scattering};
use furrier::shade::law::slab::{Slab, Stand};
use furrier::shade::law::solve;

const SOAKED: Film = Film { amount: 1.0, gloss: 0.6 };

#[test]
fn a_film_darkens_as_lambert_surfaces_do() {
    // Ångström 1925, by hand: 0.5 / (1.33² · 0.5 + 0.5).
    assert!((SOAKED.darkened(0.5) - 0.361_15).abs() < 1e-4, "{}", SOAKED.darkened(0.5));
    assert_eq!([SOAKED.darkened(0.0), SOAKED.darkened(1.0)], [0.0, 1.0]);
    assert_eq!(Film { amount: 0.0, ..SOAKED }.darkened(0.3), 0.3);
}

/// How far the colour that a wet look wears is from the dry look's for the darkened one, at the worst: of light that crosses a hair twice,
/// and of logits.
fn apart(worn_under: &Film, darkened_by: &Film) -> f64 {
    let mut worst = 0.0_f64;
    for known in known().unwrap() {
        let dry = known.scattering;
        let wet = dry.wet(worn_under, known.model, &known.parameters);
        // At the ends of what a fibre reaches, each look keeps its own distance from them.
        let reached = |colour: f32| (dry.colouring.darkest + 0.02..dry.colouring.lightest - 0.02).contains(&colour);
        for colour in [0.04_f32, 0.1, 0.3, 0.6, 0.8].into_iter().filter(|&c| reached(worn_under.darkened(c))) {
            let of_wet = wet.colouring.worn(f64::from(colour));
            let of_dry = dry.colouring.worn(f64::from(darkened_by.darkened(colour)));
            let through = |absorption: f64| (-4.0 * absorption).exp();
            worst = worst.max((through(of_wet.absorption) - through(of_dry.absorption)).abs());
            // The law is asked at the colour's own logit, and answers for the darkened one's.
            for (wet, dry) in wet.law.light.iter().zip(&dry.law.light) {
                let cubic = |of: &[f32; 4], x: f64| of.iter().rev().fold(0.0, |sum, &f| sum * x + f64::from(f));
                worst = worst.max((cubic(wet, of_wet.logit) - cubic(dry, of_dry.logit)).abs());
            }
        }
    }
    worst
}

#[test]
fn a_wet_look_is_the_dry_one_of_a_darker_colour() {
    for amount in [0.3, 1.0] {
        let film = Film { amount, ..SOAKED };
        assert!(apart(&film, &film) < 2e-3, "{amount}: {}", apart(&film, &film));
        let other = Film { amount: 0.5 * amount, ..film };
        assert!(apart(&film, &other) > 0.02, "{amount}: a film half as thick passes for it");
    }
}

/// What thick wet fur shows: its surface is smoother than that which its colours were found with.
#[test]
fn thick_wet_fur_shows_the_darkened_colour() {
    let colours = [0.8, 0.7, 0.55, 0.35, 0.2, 0.1, 0.06, 0.04];
    for name in ["fox", "mink"] {
        let fibres = Preset::load(name).unwrap().fibre;
        let look = scattering(fibres.model, &fibres.guard).unwrap().wet(&SOAKED, fibres.model, &fibres.guard);
        let absorptions = colours.map(|colour| look.colouring.worn::<f64>(colour).absorption);
        let slab =
            Slab::new(&look.fibre, &Sampler::new(&look.fibre), absorptions).albedo(&Stand::new(37.0, 10.0), 40_000);
        for (colour, shown) in colours.into_iter().zip(slab) {
            let expected = f64::from(SOAKED.darkened(colour as f32));
            println!("{name}, {colour}: {expected:.4} expected, {:+.1} %", 100.0 * (shown / expected - 1.0));
            assert!((shown / expected - 1.0).abs() < 0.1, "{name}: {colour} shows {shown} for {expected}");
        }
    }
}

/// The law that the wet look has from the dry fibre, beside the one that its own fibre would have.
#[test]
fn the_law_of_dry_hair_serves_wet_hair() {
    let dry = FibreParameters::default();
    let look = scattering(FibreModel::Medulla, &dry).unwrap();
    let fibre = Fibre::new(FibreModel::Medulla, &SOAKED.smoothed(&dry));
    let own = solve::law(&fibre, &Sampler::new(&fibre), &look.colouring, 60_000);
    for (what, apart) in apart_in_the_mean(&look.colouring, &look.law, &own) {
        println!("{what}: {:+.2} %", 100.0 * apart);
        assert!(apart.abs() < 0.1, "{what}: {apart}");
    }
}
