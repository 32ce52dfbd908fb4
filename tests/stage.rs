//! What pictures are taken with: the same for every command, so that pictures of one asset lie over each other.

use crate::bake::SMALL;
use crate::common::furrier_path;
use assert_cmd::Command;
use exr::prelude::read_first_flat_layer_from_file;
use furrier::asset::{Asset, Document};
use furrier::data::film::Film;
use furrier::data::light::Light;
use furrier::data::subject::Subject;
use furrier::math::{DVec3, Vec3};
use furrier::stage::background::Background;
use furrier::stage::light::{Asked, parse};
use furrier::stage::tone::{Development, Tone, develop};
use predicates::prelude::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::f32::consts::{PI, TAU};
use std::path::{Path, PathBuf};

const SIZE: [usize; 2] = [400, 300];

/// Bare egg-shaped skin around a small furred triangle that nobody sees, cameras and lights.
fn egg() -> Document {
    let mut document = Document::made("egg");
    let mut primitives = Vec::new();
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=24_u32 {
        for column in 0..=36_u32 {
            let (polar, azimuth) = (PI * row as f32 / 24.0, TAU * column as f32 / 36.0);
            let direction = Vec3::new(polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin());
            points.push(direction * Vec3::new(0.16, 0.1, 0.09 + 0.03 * direction.x) + Vec3::new(0.3, 0.1, -0.2));
            if row < 24 && column < 36 {
                let at = |down, along| (row + down) * 37 + column + along;
                // Poles are points: one triangle of each pair.
                triangles.extend((row > 0).then(|| [at(0, 0), at(0, 1), at(1, 1)]));
                triangles.extend((row < 23).then(|| [at(0, 0), at(1, 1), at(1, 0)]));
            }
        }
    }
    let inside = [Vec3::ZERO, Vec3::X, Vec3::Z].map(|p| p * 0.01 + Vec3::new(0.3, 0.1, -0.2));
    for (name, colour, points, triangles) in [
        ("eye", [0.4, 0.25, 0.15], &points[..], &triangles[..]),
        ("fur", [0.5, 0.5, 0.5], &inside[..], &[[0, 2, 1]][..]),
    ] {
        let pbr = json!({"baseColorFactor": [colour[0], colour[1], colour[2], 1.0]});
        let material = document.push("materials", json!({"name": name, "pbrMetallicRoughness": pbr}));
        let bytes: Vec<u8> = points.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
        let view = document.push_view(&bytes, Some(34962));
        let [low, high] = [Vec3::min, Vec3::max].map(|of| points.iter().copied().reduce(of).unwrap().to_array());
        let position = json!({"bufferView": view, "componentType": 5126, "count": points.len(), "type": "VEC3",
            "min": low, "max": high});
        let position = document.push("accessors", position);
        let bytes: Vec<u8> = triangles.iter().flatten().copied().flat_map(u32::to_le_bytes).collect();
        let view = document.push_view(&bytes, Some(34963));
        let count = 3 * triangles.len();
        let indices = json!({"bufferView": view, "componentType": 5125, "count": count, "type": "SCALAR"});
        let indices = document.push("accessors", indices);
        primitives.push(json!({"attributes": {"POSITION": position}, "indices": indices, "material": material}));
    }
    let mesh = document.push("meshes", json!({"primitives": primitives}));
    document.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}}));
    let flat = json!({"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9});
    document.push("cameras", json!({"name": "flat", "type": "orthographic", "orthographic": flat}));
    document.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    let sun = json!({"name": "sun", "type": "directional", "intensity": 3, "color": [1.0, 0.5, 0.25]});
    let lamp = json!({"type": "point", "intensity": 2, "range": 5});
    document.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [sun, lamp]}});
    let lit = |i: usize| json!({"KHR_lights_punctual": {"light": i}});
    // A quarter turn about x takes −z to −y; half of one about y takes it to +z.
    let down = [-(0.5_f32.sqrt()), 0.0, 0.0, 0.5_f32.sqrt()];
    for node in [
        json!({"mesh": mesh}),
        json!({"name": "rig", "translation": [0.3, 0.2, -0.2], "scale": [2.0, 2.0, 2.0], "children": [2]}),
        json!({"name": "behind", "camera": 0, "translation": [0.0, 0.0, -0.4], "rotation": [0.0, 1.0, 0.0, 0.0]}),
        json!({"camera": 1}),
        json!({"rotation": down, "extensions": lit(0)}),
        json!({"translation": [0.0, 1.0, 0.5], "extensions": lit(1)}),
    ] {
        document.push("nodes", node);
    }
    document.push("scenes", json!({"nodes": [0, 1, 3, 4, 5]}));
    document
}

/// A folder with the egg, bare and baked.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        std::fs::write(folder.path("egg.glb"), egg().to_glb().unwrap()).unwrap();
        let mut bake = Command::new(furrier_path());
        bake.args(["bake", "--units", "m"]).arg(folder.path("egg.glb")).arg("-o").arg(folder.path("furry.glb"));
        bake.args(SMALL).assert().success();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// `render` of the egg and `view` of the baked egg, not yet run, with the same options.
    fn commands(&self, name: &str, options: &[&str]) -> [(PathBuf, Command); 2] {
        ["render", "view"].map(|which| {
            let mut command = Command::new(furrier_path());
            let out = self.path(&format!("{which}-{name}"));
            if which == "render" {
                command.args(["render", "--units", "m"]).arg(self.path("egg.glb")).arg("-o").arg(&out);
                command.args(SMALL.iter().skip_while(|option| **option != "--set"));
            } else {
                command.arg("view").arg(self.path("furry.glb")).arg("--screenshot").arg(&out);
            }
            command.args(options);
            (out, command)
        })
    }

    /// Pictures by both.
    fn both(&self, name: &str, options: &[&str]) -> [PathBuf; 2] {
        self.commands(name, options).map(|(out, mut command)| {
            command.args(["--size", &format!("{}x{}", SIZE[0], SIZE[1])]).assert().success();
            out
        })
    }
}

fn layers(path: &Path) -> BTreeMap<String, Vec<f32>> {
    let channels = read_first_flat_layer_from_file(path).unwrap().layer_data.channel_data.list;
    channels.into_iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

/// Pixels in which exactly one of two masks is set, and those of them that are no neighbours of the first one's outline.
fn strays(a: &[bool], b: &[bool]) -> [usize; 2] {
    let at = |x: i64, y: i64| {
        let inside = (0..SIZE[0] as i64).contains(&x) && (0..SIZE[1] as i64).contains(&y);
        inside && a[(y * SIZE[0] as i64 + x) as usize]
    };
    let differ: Vec<usize> = (0..a.len()).filter(|&i| a[i] != b[i]).collect();
    let far = |i: &&usize| {
        let (x, y) = ((**i % SIZE[0]) as i64, (**i / SIZE[0]) as i64);
        (-1..=1).all(|dy| (-1..=1).all(|dx| at(x + dx, y + dy) == a[**i]))
    };
    [differ.len(), differ.iter().filter(far).count()]
}

#[test]
fn bare_skin_looks_the_same_in_render_and_view() {
    let folder = Folder::new();
    let flat = ["--tone", "none", "--transparent", "--light", "dir:0,-1,0:0,0,0", "--ambient", "0.8,0.8,0.8"];
    for camera in [["--orbit", "35,12,1"], ["--orbit", "-100,50,1.3"], ["--camera", "behind"]] {
        let options = [&flat[..], &camera].concat();
        let films = folder.both("out.exr", &options).map(|path| layers(&path));
        let covered = films.each_ref().map(|film| film["A"].iter().map(|&a| a > 0.5).collect::<Vec<_>>());
        let all = covered[0].iter().filter(|c| **c).count();
        let [differ, far] = strays(&covered[0], &covered[1]);
        println!("{camera:?}: {differ} of {all} pixels differ");
        assert!(all > 5000 && far == 0 && differ * 200 <= all, "{camera:?}: {differ} of {all}, {far} far");
        assert!(!(differ_is_told(&covered[0])), "a shift by two pixels passes");

        let [render, view] = folder.both("out.png", &options).map(|path| image::open(path).unwrap().to_rgba8());
        let opaque = || render.pixels().zip(view.pixels()).filter(|(a, b)| a.0[3] == 255 && b.0[3] == 255);
        let most_colour = opaque().flat_map(|(a, b)| (0..3).map(|c| a.0[c].abs_diff(b.0[c]))).max().unwrap();
        assert!(opaque().count() > 5000 && most_colour <= 2, "{camera:?}: colours differ by {most_colour}");

        // Distance along the ray: the same surface. `view` has the nearest of a pixel's samples, which counts beside outlines.
        let whole = |i: &usize| films.iter().all(|film| film["A"][*i] == 1.0);
        let off = |i: usize| (films[1]["Z"][i] / films[0]["Z"][i] - 1.0).abs();
        let mut off: Vec<f32> = (0..covered[0].len()).filter(whole).map(off).collect();
        off.sort_by(f32::total_cmp);
        let [half, most, all] = [off.len() / 2, off.len() * 98 / 100, off.len() - 1].map(|i| off[i]);
        println!("{camera:?}: distances differ by {half}, {most}, {all}; colours by {most_colour}");
        assert!(half < 0.002 && most < 0.01 && all < 0.1, "{camera:?}: distances differ by {half}, {most}, {all}");
        let channels: Vec<&str> = films[1].keys().map(String::as_str).collect();
        assert_eq!(channels, ["A", "B", "G", "R", "Z"]);
    }
}

/// Whether a mask passes for itself moved by two pixels.
fn differ_is_told(mask: &[bool]) -> bool {
    let mut moved = mask.to_vec();
    moved.rotate_right(2);
    let [differ, far] = strays(mask, &moved);
    far == 0 && differ * 200 <= mask.iter().filter(|c| **c).count()
}

#[test]
fn cameras_and_lights_of_the_asset_go_by_name() {
    let subject = Asset::new(egg(), vec![]).unwrap().subject(0.5, |_, _| 0.0).unwrap();
    let camera = subject.cameras[0].value.clone().unwrap();
    assert_eq!(subject.cameras[0].names, ["behind"]);
    assert!(DVec3::from(camera.eye).distance(DVec3::new(0.15, 0.1, -0.5)) < 1e-6, "{camera:?}");
    assert!(DVec3::from(camera.target).distance(DVec3::new(0.15, 0.1, -0.1)) < 1e-3, "{camera:?}");
    assert!((camera.vfov_deg - 0.6_f64.to_degrees()).abs() < 1e-9);
    let light = |name: &str| Asked::Named(name.into()).light(&subject).unwrap();
    let Light::Directional(sun) = light("sun") else { panic!("the sun is no sun") };
    assert!(sun.to_light.distance(Vec3::Y) < 1e-6 && sun.irradiance == Vec3::new(3.0, 1.5, 0.75), "{sun:?}");
    let Light::Point(lamp) = light("light_1") else { panic!("the lamp is no lamp") };
    let place = lamp.position_m.as_dvec3() + subject.origin_m;
    assert!(place.distance(DVec3::new(0.0, 0.5, 0.25)) < 1e-6 && lamp.range_m == Some(2.5), "{lamp:?}");
    let unknown = Asked::Named("moon".into()).light(&subject).unwrap_err();
    assert_eq!(unknown.expected.unwrap(), "one of: sun, light_1");

    let folder = Folder::new();
    for (options, answer) in [
        (["--camera", "front"], "one of: behind, flat"),
        (["--camera", "flat"], "orthographic"),
        (["--light", "moon"], "one of: sun, light_1"),
        (["--orbit", "1,90,1"], "degrees from -89 to 89"),
        (["--background", "1,2"], "backdrop, or R,G,B"),
        (["--exposure", "nan"], "-64 to 64"),
    ] {
        for (_, mut command) in folder.commands("no.png", &options) {
            command.args(["--size", "16x16"]).assert().code(2).stderr(predicate::str::contains(answer));
        }
    }
    // By name and by numbers it is the same light.
    let [named, given] = ["sun", "dir:0,-1,0:3,1.5,0.75"]
        .map(|light| folder.both("sun.exr", &["--light", light]).map(|path| layers(&path)["R"].iter().sum::<f32>()));
    for (named, given) in named.iter().zip(given) {
        assert!((named - given).abs() < 1e-4 * given && given > 10.0, "{named} and {given}");
    }
}

#[test]
fn an_environment_lights_both_alike() {
    let folder = Folder::new();
    // 8 × 4 pixels, the upper row of radiance 4.
    let mut map = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".to_vec();
    map.extend((0..32).flat_map(|i| if i < 8 { [128, 128, 128, 131] } else { [0; 4] }));
    let path = folder.path("above.hdr");
    std::fs::write(&path, map).unwrap();
    let options = ["--env", path.to_str().unwrap(), "--orbit", "0,60,1", "--light", "dir:0,-1,0:0,0,0"];
    let [render, view] = folder.both("env.exr", &options).map(|path| layers(&path)["G"].iter().sum::<f32>());
    // What `view` has more is the highlight of bare skin.
    assert!(render > 100.0 && (1.0..1.3).contains(&(view / render)), "{render} and {view}");
    for (_, mut command) in folder.commands("no.png", &["--light", "dir:0,-1,0:1,1,1"].repeat(16)) {
        command.args(["--env"]).arg(&path).assert().code(2).stderr(predicate::str::contains("at most 15"));
    }
}

#[test]
fn every_command_takes_the_same_flags() {
    let mut program = furrier::cli::definition();
    program.build();
    let flags = |path: &[&str]| -> BTreeMap<String, String> {
        let command = path.iter().fold(&program, |command, name| command.find_subcommand(name).unwrap());
        let stage = command.get_arguments().filter(|a| a.get_help_heading() == Some("Camera and light"));
        stage.map(|a| (a.get_id().to_string(), format!("{:?} {:?}", a.get_default_values(), a.get_long()))).collect()
    };
    let render = flags(&["render"]);
    let names: Vec<&str> = render.keys().map(String::as_str).collect();
    let expected = "ambient background camera env exposure lights orbit size tone transparent";
    assert_eq!(names.join(" "), expected);
    assert_eq!(render, flags(&["view"]));
    assert_eq!(render, flags(&["report", "render"]));
}

#[test]
fn lights_are_read_or_refused() {
    let read = |text: &str| parse(text).and_then(|asked| asked.light(&Subject::default()));
    let Ok(Light::Directional(light)) = read("dir:0,-2,0:1,2,3") else { panic!("no direction") };
    assert_eq!((light.to_light, light.irradiance), (Vec3::Y, Vec3::new(1.0, 2.0, 3.0)));
    let Ok(Light::Point(light)) = read("point:1,2,3:4,5,6") else { panic!("no point") };
    assert_eq!((light.position_m, light.intensity), (Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)));
    let Ok(Light::Spot(light)) = read("spot:1,2,3:0,-2,0:60:4,5,6") else { panic!("no spot") };
    assert!(light.direction == Vec3::NEG_Y && (light.outer_cos - 0.5).abs() < 1e-6, "{light:?}");
    assert_eq!(light.point.position_m, Vec3::new(1.0, 2.0, 3.0));
    for bad in [
        "0,-1,0:1,1,1",
        "dir:0,0,0:1,1,1",
        "dir:0,1,0:1,1",
        "dir:0,1,x:1,1,1",
        "dir:0,1,0:-1,0,0",
        "dir:1,1,1,1:1,1,1",
        "point:0,1:1,1,1",
        "point:0,1,nan:1,1,1",
        "point:0,1,0:1,1,1:2",
        "spot:0,1,0:1,1,1",
        "spot:0,1,0:0,0,0:30:1,1,1",
        "spot:0,1,0:0,1,0:120:1,1,1",
    ] {
        assert_eq!(read(bad).unwrap_err().parameter, Some("light"), "{bad}");
    }
}

#[test]
fn tones_exposure_and_background() {
    let mut film = Film::new(2, 1);
    film.radiance = vec![Vec3::new(0.2, 0.4, 1.6), Vec3::splat(0.1)];
    film.alpha = vec![1.0, 0.5];
    let seen = |development: Development| develop(&film, &development).pixels;
    let plain = Development { tone: Tone::None, background: Background::Transparent, ..Development::default() };
    let coded = |linear: f32| (255.0 * (1.055 * linear.powf(1.0 / 2.4) - 0.055)).round() as u8;
    assert_eq!(seen(plain), [coded(0.2), coded(0.4), 255, 255, coded(0.2), coded(0.2), coded(0.2), 128]);
    let darker = seen(Development { exposure_ev: -1.0, ..plain });
    assert_eq!(darker[..4], [coded(0.1), coded(0.2), coded(0.8), 255]);
    // Neutral leaves dark colours alone and keeps bright ones apart.
    let neutral = seen(Development { tone: Tone::Neutral, ..plain });
    assert!(neutral[4..] == seen(plain)[4..] && neutral[2] < 255 && neutral[2] > neutral[1], "{neutral:?}");
    let before = seen(Development { background: Background::Colour(Vec3::X), ..plain });
    assert_eq!(before[4..], [coded(0.6), coded(0.1), coded(0.1), 255]);
    assert_eq!("0.5,1,0".parse::<Background>().unwrap(), Background::Colour(Vec3::new(0.5, 1.0, 0.0)));
    assert!("0.5,2,0".parse::<Background>().is_err() && "wall".parse::<Background>().is_err());
}
