//! What is tried with mutated bytes: each target reads as the command line does, and writes where reading went well.

use super::{cases, mutate};
use furrier::asset::image;
use furrier::math::hash::Stream;
use furrier::preset::Preset;
use furrier::preset::keys::tables;
use furrier::stage::environment::Environment;
use std::cell::OnceCell;
use std::path::Path;

/// A kind of file, with whole ones to start from.
pub struct Target {
    name: String,
    seeds: OnceCell<Vec<Vec<u8>>>,
}

impl Target {
    /// By its name.
    pub fn named(name: &str) -> Self {
        Self { name: name.to_owned(), seeds: OnceCell::new() }
    }

    /// Mutates one of the whole files and uses what comes of it; says whether it was accepted.
    pub fn try_case(&self, case: u64, folder: &Path) -> bool {
        let seeds = self.seeds.get_or_init(|| cases::seeds(&self.name));
        let mut stream = Stream::new(case);
        let pick = |stream: &mut Stream| seeds[stream.bits() as usize % seeds.len()].clone();
        let seed = if seeds.is_empty() { Vec::new() } else { pick(&mut stream) };
        let text = || String::from_utf8(seed.clone()).expect("a text");
        match self.name.as_str() {
            "glb" => cases::mesh(&cases::mutated_glb(&seed, &mut stream), "in.glb", folder, case),
            "gltf" => {
                std::fs::write(folder.join("in.bin"), cases::binary()).expect("written");
                cases::mesh(&cases::mutated_gltf(&text(), &mut stream), "in.gltf", folder, case)
            }
            "furry" => cases::furry(&cases::mutated_glb(&seed, &mut stream), folder),
            "obj" => {
                let text = text();
                let (obj, mtl) = text.split_once(cases::CUT).expect("two texts");
                let mtl = mutate::text(mtl, &mut stream);
                std::fs::write(folder.join("a.mtl"), mtl).expect("written");
                cases::mesh(&mutate::text(obj, &mut stream), "in.obj", folder, case)
            }
            "preset" => preset(&mutate::text(&text(), &mut stream), &mut stream),
            "hdr" => environment(&mutate::bytes(&seed, &mut stream), &folder.join("in.hdr")),
            "exr" => environment(&mutate::bytes(&seed, &mut stream), &folder.join("in.exr")),
            "png" => {
                let path = folder.join("in.png");
                std::fs::write(&path, mutate::bytes(&seed, &mut stream)).expect("written");
                match image::load(&path) {
                    Ok(image) => {
                        let whole = image.pixels.len() == (image.width * image.height * image.channels) as usize;
                        assert!(whole, "an image without all its pixels");
                        true
                    }
                    Err(_) => false,
                }
            }
            "panics" => panic!("a planted fault"),
            "grows" => vec![1_u8; 3 << 30].iter().all(|&byte| byte == 1),
            "hangs" => loop {
                std::hint::spin_loop();
            },
            "leaves" => {
                std::fs::write(folder.join("out.glb"), "half").expect("written");
                cases::nothing_is_left(folder);
                false
            }
            name => panic!("no target {name}"),
        }
    }
}

/// A preset from its text, then a setting of a key there is with a value that may fit.
fn preset(text: &[u8], stream: &mut Stream) -> bool {
    let read = std::str::from_utf8(text).ok().and_then(|text| Preset::from_toml(text).ok());
    let accepted = read.is_some();
    let preset = read.unwrap_or_else(|| Preset::load("fox").expect("a preset"));
    let keys: Vec<_> = tables().into_iter().flat_map(|table| table.keys).collect();
    let key = &keys[stream.bits() as usize % keys.len()];
    let default = key.default.as_ref().map_or("{ relative = 0.5 }".to_owned(), |value| value.to_string());
    let setting = mutate::text(&format!("{}={default}", key.key), stream);
    let setting = String::from_utf8_lossy(&setting).into_owned();
    if let Ok(set) = preset.with_settings(&[setting]) {
        set.checked().expect("what was set is checked");
    }
    accepted
}

/// An environment map, and the lights that stand for it.
fn environment(bytes: &[u8], path: &Path) -> bool {
    std::fs::write(path, bytes).expect("written");
    match Environment::read(path) {
        Ok(map) => {
            let lights = map.median_cut(16);
            assert!(lights.iter().all(|light| light.irradiance.is_finite()), "a light of no brightness");
            true
        }
        Err(error) => {
            assert!(error.file.is_some() && error.found.is_some(), "an error that says too little: {error}");
            false
        }
    }
}
