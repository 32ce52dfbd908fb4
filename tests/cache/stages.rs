//! The same bytes with a cache and without, cold and warm; and what is taken from it when something changes.

use furrier::asset::{Fallback, Reading};
use furrier::bake::units::Units;
use furrier::bake::{Baked, Method, Request, bake};
use furrier::cache::Store;
use furrier::preset::Preset;
use std::path::{Path, PathBuf};

/// Few texels and few hairs: quick to bake.
const SMALL: &[&str] = &[
    "shells.layers=4",
    "shells.texture_size=16",
    "shells.tile_mm=8",
    "fins.texture_width=16",
    "fins.texture_height=16",
    "guard.density_per_cm2=40",
    "undercoat.density_per_cm2=200",
    "guard.length.mm=4",
    "undercoat.length.mm=3",
];

/// A built-in preset with little hair, changed by `settings`.
fn preset(name: &str, settings: &[&str]) -> Preset {
    let all: Vec<String> = SMALL.iter().chain(settings).map(|&setting| setting.to_owned()).collect();
    Preset::load(name).unwrap().with_settings(&all).unwrap()
}

fn request(input: &str, preset: Preset) -> Request {
    Request {
        input: input.into(),
        reading: Reading::default(),
        out: PathBuf::new(),
        preset,
        presets: vec![],
        materials: vec![],
        units: Units::Auto,
        method: Method::Lapped,
        seed: 0,
        fallback: Fallback::Shells(2),
        judge: false,
        cache: None,
        draft: false,
    }
}

/// Bakes into `folder`: the file's bytes, and what was baked.
fn baked(request: &Request, folder: &Path) -> (Vec<u8>, Baked) {
    let out = folder.join("out.glb");
    let baked = bake(&Request { out: out.clone(), ..request.clone() }, &mut |_| {}).unwrap();
    (std::fs::read(out).unwrap(), baked)
}

/// How many values of a stage were found, and how many made.
fn uses(baked: &Baked, stage: &str) -> [u32; 2] {
    let uses = baked.cached.as_ref().unwrap().stages.get(stage).copied().unwrap_or_default();
    [uses.found, uses.made]
}

/// Fails unless a request gives the same bytes and the same figures without a cache, with an empty one, and with what that
/// run has kept; then nothing is made. Gives the warm run.
fn is_the_same_cold_and_warm(request: &Request) -> Baked {
    let folder = tempfile::tempdir().unwrap();
    let without = baked(request, folder.path());
    assert!(without.1.cached.is_none());
    let with = Request { cache: Some(Store::new(folder.path().join("cache"))), ..request.clone() };
    let [cold, warm] = [baked(&with, folder.path()), baked(&with, folder.path())];
    for (which, (bytes, baked)) in [("cold", &cold), ("warm", &warm)] {
        assert!(*bytes == without.0, "{which}: the file differs");
        assert!(baked.coat == without.1.coat, "{which}: the coat differs");
        assert_eq!(baked.accuracy, without.1.accuracy, "{which}");
        assert_eq!(baked.notes, without.1.notes, "{which}");
        assert_eq!(baked.warnings, without.1.warnings, "{which}");
        let measures = |baked: &Baked| baked.laid.iter().map(|laid| laid.measures.clone()).collect::<Vec<_>>();
        assert_eq!(measures(baked), measures(&without.1), "{which}");
    }
    let cached = |baked: &Baked| baked.cached.clone().unwrap().stages;
    assert!(!cached(&cold.1).is_empty());
    assert!(cached(&cold.1).values().all(|uses| uses.made > 0), "{:?}", cached(&cold.1));
    assert!(cached(&warm.1).values().all(|uses| uses.made == 0 && uses.found > 0), "{:?}", cached(&warm.1));
    warm.1
}

#[test]
fn lapped_coats_are_the_same_from_the_cache() {
    let warm = is_the_same_cold_and_warm(&request("sample:torus", preset("fox", &[])));
    assert_eq!(uses(&warm, "tile"), [1, 0]);
    let steps: Vec<&str> = warm.steps.0.iter().map(|step| step.name.as_str()).collect();
    assert!(!steps.contains(&"tile") && !steps.contains(&"grow") && steps.contains(&"cache"), "{steps:?}");
}

#[test]
fn judged_coats_are_the_same_from_the_cache() {
    let request = Request { judge: true, ..request("sample:sphere", preset("mink", &[])) };
    let warm = is_the_same_cold_and_warm(&request);
    assert_eq!((uses(&warm, "tile"), uses(&warm, "judge")), ([1, 0], [1, 0]));
    assert_eq!(warm.accuracy.len(), 1);
}

#[test]
fn an_atlas_is_the_same_from_the_cache() {
    let request = Request {
        method: Method::Atlas { texels: Some(64) },
        judge: true,
        ..request("sample:sphere", preset("sheep", &[]))
    };
    is_the_same_cold_and_warm(&request);
}

#[test]
fn several_tiles_are_the_same_from_the_cache() {
    let folder = tempfile::tempdir().unwrap();
    let ramp = image::GrayImage::from_fn(16, 4, |x, _| image::Luma([(x * 16) as u8]));
    ramp.save(folder.path().join("ramp.png")).unwrap();
    let other = toml::to_string(&preset("plush", &[])).unwrap();
    std::fs::write(folder.path().join("other.toml"), other).unwrap();
    let region = format!(
        "regions=[{{ preset = {:?}, map = {:?} }}]",
        folder.path().join("other.toml"),
        folder.path().join("ramp.png")
    );
    let warm = is_the_same_cold_and_warm(&request("sample:plane", preset("fox", &[&region])));
    assert_eq!((warm.coat.tiles.len(), uses(&warm, "tile")), (2, [2, 0]));
}

#[test]
fn another_colour_takes_what_rays_told() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Some(Store::new(folder.path().join("cache")));
    let first = Request { cache, judge: true, ..request("sample:sphere", preset("fox", &[])) };
    let judged = baked(&first, folder.path()).1.accuracy;
    let colours = [
        "colour.guard=[[0.9, 0.1, 0.1], [0.1, 0.9, 0.1], [0.1, 0.1, 0.9]]",
        "colour.undercoat=[[0.2, 0.3, 0.4], [0.5, 0.4, 0.3], [0.9, 0.8, 0.7]]",
        "colour.variation=0.7",
        "colour.skin=[0.3, 0.9, 0.2]",
        "fibre.guard.roughness=0.5",
    ];
    for colour in colours {
        let Ok(preset) = preset("fox", &[]).with_settings(&[colour.to_owned()]) else { panic!("{colour}") };
        let changed = Request { preset, ..first.clone() };
        let without = baked(&Request { cache: None, judge: false, ..changed.clone() }, folder.path()).0;
        let (bytes, baked) = baked(&Request { judge: false, ..changed }, folder.path());
        assert!(bytes == without, "{colour}: the file differs");
        let found = ["tile", "tile-ends", "tile-gains", "patches", "comb"].map(|stage| uses(&baked, stage));
        assert_eq!(found, [[0, 1], [1, 0], [1, 0], [1, 0], [1, 0]], "{colour}");
    }
    // How much hair covers is no matter of its colour: the same without a cache, and not looked at again with one.
    let changed = Request { preset: preset("fox", &[colours[0]]), ..first };
    assert_eq!(baked(&Request { cache: None, ..changed.clone() }, folder.path()).1.accuracy, judged);
    let again = baked(&changed, folder.path()).1;
    assert_eq!((uses(&again, "judge"), &again.accuracy), ([1, 0], &judged));
}

#[test]
fn what_changes_more_than_colour_is_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Some(Store::new(folder.path().join("cache")));
    let first = Request { cache, ..request("sample:sphere", preset("fox", &[])) };
    baked(&first, folder.path());
    // What is made again of ends and gains.
    for (setting, made) in [
        ("guard.diameter_um=90", [true, true]),
        ("guard.taper=0.9", [true, true]),
        ("guard.shape.bend_deg=3", [true, true]),
        ("guard.density_per_cm2=50", [true, true]),
        ("shells.layers=5", [true, true]),
        ("undercoat.density_per_cm2=300", [true, true]),
        ("groom.lean_deg=11", [false, true]),
        ("fins.thickness_mm=1", [false, false]),
    ] {
        let preset = preset("fox", &[setting]);
        let changed = Request { preset, ..first.clone() };
        let without = baked(&Request { cache: None, ..changed.clone() }, folder.path()).0;
        let (bytes, baked) = baked(&changed, folder.path());
        assert!(bytes == without, "{setting}: the file differs");
        let again = ["tile", "tile-ends", "tile-gains"].map(|stage| uses(&baked, stage)[1] > 0);
        assert_eq!(again, [true, made[0], made[1]], "{setting}");
    }
    let (_, baked) = baked(&Request { seed: 1, ..first }, folder.path());
    assert_eq!(uses(&baked, "tile"), [0, 1]);
}

#[test]
fn assets_share_the_tile_of_a_preset() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Some(Store::new(folder.path().join("cache")));
    let of = |input: &str| Request { cache: cache.clone(), ..request(input, preset("fox", &[])) };
    assert_eq!(uses(&baked(&of("sample:sphere"), folder.path()).1, "tile"), [0, 1]);
    assert_eq!(uses(&baked(&of("sample:torus"), folder.path()).1, "tile"), [1, 0]);
    assert_eq!(uses(&baked(&of("sample:hat"), folder.path()).1, "tile"), [1, 0]);
}

/// The files of a cache.
fn values(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { values(&path) } else { vec![path] }).collect()
}

#[test]
fn damaged_values_are_made_again_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("cache");
    let with = Request { cache: Some(Store::new(&cache)), ..request("sample:plane", preset("fox", &[])) };
    let (sound, _) = baked(&with, folder.path());
    let files = values(&cache);
    for (i, file) in files.iter().enumerate() {
        let mut bytes = std::fs::read(file).unwrap();
        let at = (bytes.len() * (i + 1) / (files.len() + 1)).max(100);
        bytes[at] ^= 4;
        std::fs::write(file, bytes).unwrap();
    }
    let (bytes, again) = baked(&with, folder.path());
    assert!(bytes == sound, "the file differs");
    let told: Vec<_> = again.warnings.iter().filter(|w| w.contains("damaged in the cache")).collect();
    assert_eq!(told.len(), files.len(), "{told:?}");
    let (bytes, mended) = baked(&with, folder.path());
    assert!(bytes == sound && mended.warnings.is_empty(), "{:?}", mended.warnings);
    assert_eq!(uses(&mended, "tile"), [1, 0]);
}

#[test]
fn a_cache_that_takes_nothing_is_told_and_done_without() {
    let folder = tempfile::tempdir().unwrap();
    // Permissions do not stop the superuser; a file where the folder must be does.
    let cache = folder.path().join("cache");
    std::fs::write(&cache, "in the way").unwrap();
    let without = request("sample:plane", preset("fox", &[]));
    let with = Request { cache: Some(Store::new(&cache)), ..without.clone() };
    let (bytes, baked_with) = baked(&with, folder.path());
    assert!(bytes == baked(&without, folder.path()).0, "the file differs");
    let told: Vec<_> = baked_with.warnings.iter().filter(|w| w.contains("takes nothing more")).collect();
    assert_eq!(told.len(), 1, "{:?}", baked_with.warnings);
    assert_eq!(std::fs::read(&cache).unwrap(), b"in the way");
}

#[test]
fn two_bakes_may_use_one_cache_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Some(Store::new(folder.path().join("cache")));
    let request = Request { cache, ..request("sample:torus", preset("fox", &[])) };
    let of = |name: &str| {
        let folder = folder.path().join(name);
        std::fs::create_dir(&folder).unwrap();
        let (bytes, baked) = baked(&request, &folder);
        assert!(!baked.warnings.iter().any(|w| w.contains("cache")), "{:?}", baked.warnings);
        bytes
    };
    let files = std::thread::scope(|scope| {
        let of = &of;
        ["a", "b", "c"].map(|name| scope.spawn(move || of(name))).map(|thread| thread.join().unwrap())
    });
    assert!(files[0] == files[1] && files[0] == files[2], "the files differ");
}

/// Keys are made of what was read, so that a file that becomes another one meanwhile leaves nothing wrong behind.
#[test]
fn an_input_that_changes_while_it_is_read_leaves_nothing_wrong_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["sphere", "torus"] {
        let document = furrier::asset::load(&format!("sample:{name}")).unwrap().document;
        std::fs::write(path(name), document.to_glb().unwrap()).unwrap();
    }
    let input = path("in.glb");
    let put = |name: &str| {
        std::fs::copy(path(name), path("next")).unwrap();
        std::fs::rename(path("next"), &input).unwrap();
    };
    let of = |cache: Option<Store>| Request { cache, ..request(input.to_str().unwrap(), preset("fox", &[])) };
    let whole = ["sphere", "torus"].map(|name| {
        put(name);
        baked(&of(None), folder.path()).0
    });
    let with = of(Some(Store::new(path("cache"))));
    let done = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(std::sync::atomic::Ordering::Relaxed) {
                put("sphere");
                put("torus");
            }
        });
        for _ in 0..6 {
            let bytes = baked(&with, folder.path()).0;
            assert!(whole.contains(&bytes), "neither the one nor the other");
        }
        done.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    for (name, whole) in ["sphere", "torus"].iter().zip(whole) {
        put(name);
        assert!(baked(&with, folder.path()).0 == whole, "{name}: the file differs");
    }
}
