//! Material files: what a material's colour is, and the image that it is painted with.

use super::lines;
use crate::asset::document::Document;
use crate::asset::encode::numbers;
use crate::asset::{image, text, uri};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Materials by name.
pub type Materials = HashMap<String, Material>;

/// What is read of a material.
#[derive(Clone, Debug, Default)]
pub struct Material {
    /// `Kd`, linear RGB.
    colour: Option<[f32; 3]>,
    /// `d`.
    opacity: Option<f32>,
    /// `map_Kd` and its glTF image.
    texture: Option<(Map, usize)>,
    /// Statements of a colour that are not read.
    passed_over: Vec<String>,
}

impl Material {
    /// Whether it is painted with an image.
    pub fn is_textured(&self) -> bool {
        self.texture.is_some()
    }

    /// The same without its image.
    pub fn without_texture(self) -> Self {
        Self { texture: None, ..self }
    }

    /// As glTF has it; its texture is added to the document.
    pub fn to_gltf(&self, name: &str, document: &mut Document) -> Value {
        let mut pbr = json!({"metallicFactor": 0.0, "roughnessFactor": 0.9});
        // What exporters write beside an image is seldom meant as a factor on it.
        let [r, g, b] = self.colour.filter(|_| self.texture.is_none()).unwrap_or([1.0; 3]);
        let opacity = self.opacity.filter(|d| *d > 0.0 && *d < 1.0);
        let factor = [r, g, b, opacity.unwrap_or(1.0)];
        if factor != [1.0; 4] {
            pbr["baseColorFactor"] = numbers(&factor);
        }
        if let Some((map, image)) = &self.texture {
            pbr["baseColorTexture"] = map.slot(*image, document);
        }
        let mut material = json!({"name": name, "pbrMetallicRoughness": pbr});
        if opacity.is_some() {
            material["alphaMode"] = json!("BLEND");
        }
        material
    }
}

/// Reads the material files that `mtllib` lines name, one or several in each, and says what cannot be read.
pub fn read(libraries: &[String], document: &mut Document, warnings: &mut Vec<String>) -> Materials {
    let mut found = Materials::new();
    let Some(folder) = document.folder.clone() else { return found };
    for library in libraries.iter().flat_map(|line| files(line, &folder)) {
        let path = match library {
            Ok(name) => name,
            Err(name) => {
                warnings.push(format!("material file {name:?} is not in the input's folder; its colours are missing"));
                continue;
            }
        };
        match uri::read_file(&folder.join(&path)) {
            Ok(bytes) => {
                document.files.push(folder.join(&path));
                let parent = Path::new(&path).parent().unwrap_or(Path::new("")).to_owned();
                file(&text::decode(&bytes).0, &parent, document, &mut found, warnings);
            }
            Err(error) => warnings.push(format!("material file {path:?} passed over: {}", error.what)),
        }
    }
    found
}

/// The files that a line names: their paths in the folder, or the names that lead nowhere. A name may hold spaces.
fn files(line: &str, folder: &Path) -> Vec<Result<String, String>> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (mut found, mut at) = (Vec::new(), 0);
    while at < words.len() {
        let longest =
            (at + 1..=words.len()).rev().find_map(|end| Some((end, uri::find(&words[at..end].join(" "), folder)?)));
        match longest {
            Some((end, path)) => {
                found.push(Ok(path));
                at = end;
            }
            None => {
                found.push(Err(words[at].to_owned()));
                at += 1;
            }
        }
    }
    // Where none is there, it may as well be one name with spaces.
    if found.iter().all(Result::is_err) { vec![Err(line.to_owned())] } else { found }
}

/// Reads one file, which lies in `parent` below the input's folder.
fn file(text: &str, parent: &Path, document: &mut Document, found: &mut Materials, warnings: &mut Vec<String>) {
    let mut name: Option<String> = None;
    let mut each = |keyword: &str, rest: &str| {
        let keyword = keyword.to_ascii_lowercase();
        if keyword == "newmtl" {
            found.insert(rest.to_owned(), Material::default());
            name = Some(rest.to_owned());
        }
        let Some(material) = name.as_ref().and_then(|name| found.get_mut(name)) else { return };
        let told = || name.as_deref().unwrap_or_default();
        match keyword.as_str() {
            "kd" => match colour(rest) {
                Some(colour) => {
                    let beyond = colour.iter().any(|&c| c > 1.0);
                    if beyond {
                        warnings.push(format!("material {:?}: Kd {rest} goes beyond 1; taken as parts of 255", told()));
                    }
                    let whole = if beyond { 255.0 } else { 1.0 };
                    material.colour = Some(colour.map(|c| (c / whole).clamp(0.0, 1.0)));
                }
                None => material.passed_over.push(format!("Kd {rest}")),
            },
            "d" => material.opacity = rest.split_whitespace().next_back().and_then(|d| d.parse().ok()),
            "map_kd" => match Map::of(rest).image(parent, document) {
                Ok(found) => material.texture = Some(found),
                Err(fault) => warnings.push(format!("material {:?}: {fault}; its Kd is used alone", told())),
            },
            "ka" | "ke" | "map_ka" | "map_ke" => material.passed_over.push(format!("{keyword} {rest}")),
            _ => {}
        }
    };
    // Nothing in it can fail.
    let _ = lines::each(text, |keyword, rest| {
        each(keyword, rest);
        Ok(())
    });
    let mut blank: Vec<(&String, &Material)> =
        found.iter().filter(|(_, m)| m.colour.is_none() && !m.is_textured()).collect();
    blank.sort_by_key(|(name, _)| *name);
    for (name, material) in blank.into_iter().filter(|(_, m)| !m.passed_over.is_empty()) {
        let all = material.passed_over.join(", ");
        warnings.push(format!(
            "material {name:?}: no Kd of three numbers and no map_Kd is read, only {all}; taken as white"
        ));
    }
}

/// One or three numbers.
fn colour(rest: &str) -> Option<[f32; 3]> {
    let values: Vec<f32> = rest.split_whitespace().map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let colour = match values[..] {
        [grey] => [grey; 3],
        [r, g, b, ..] => [r, g, b],
        _ => return None,
    };
    colour.iter().all(|c| c.is_finite()).then_some(colour)
}

/// An image and how it is laid on.
#[derive(Clone, Debug)]
struct Map {
    name: String,
    offset: [f32; 2],
    scale: [f32; 2],
    clamp: bool,
}

impl Map {
    /// Options, then a name that may hold spaces.
    fn of(rest: &str) -> Self {
        let mut map = Self { name: String::new(), offset: [0.0; 2], scale: [1.0; 2], clamp: false };
        let mut rest = rest.trim();
        while let Some((option, more)) = rest.strip_prefix('-').and_then(|rest| rest.split_once(char::is_whitespace)) {
            let (wanted, numeric) = match option.to_ascii_lowercase().as_str() {
                "o" | "s" | "t" => (3, true),
                "mm" => (2, true),
                "bm" | "boost" | "texres" => (1, true),
                "blendu" | "blendv" | "cc" | "clamp" | "imfchan" | "type" | "colorspace" => (1, false),
                _ => break,
            };
            rest = more.trim_start();
            let mut values = Vec::new();
            for _ in 0..wanted {
                let (word, more) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                if (numeric && word.parse::<f32>().is_err()) || more.is_empty() {
                    break;
                }
                values.push(word);
                rest = more.trim_start();
            }
            let number = |i: usize, default| {
                values.get(i).and_then(|v| v.parse().ok()).filter(|v: &f32| v.is_finite()).unwrap_or(default)
            };
            match option.to_ascii_lowercase().as_str() {
                "o" => map.offset = [number(0, 0.0), number(1, 0.0)],
                "s" => map.scale = [number(0, 1.0), number(1, 1.0)],
                "clamp" => map.clamp = values == ["on"],
                _ => {}
            }
        }
        map.name = rest.to_owned();
        map
    }

    /// With its image added to the document; where it cannot be, what is wrong.
    fn image(self, parent: &Path, document: &mut Document) -> Result<(Self, usize), String> {
        let name = &self.name;
        let Some(folder) = document.folder.clone() else { return Err("it has no folder".into()) };
        // Beside the material file, or else beside the mesh.
        let beside = uri::find(name, &folder.join(parent)).map(|found| parent.join(found));
        let Some(path) = beside.or_else(|| uri::find(name, &folder).map(PathBuf::from)) else {
            return Err(format!("texture {name:?} is not in the input's folder"));
        };
        let bytes = uri::read_file(&folder.join(&path)).map_err(|error| format!("texture {name:?}: {}", error.what))?;
        if image::media_type(&bytes).is_none_or(|media| media == "image/ktx2") {
            return Err(format!("texture {name:?} is neither PNG, JPEG nor WebP; save it as one of these"));
        }
        let path = path.to_string_lossy().replace('\\', "/");
        let image = document.push("images", json!({"uri": uri::encode(&path)}));
        Ok((self, image))
    }

    /// A texture of `image`, added to the document, as a material names it.
    fn slot(&self, image: usize, document: &mut Document) -> Value {
        let mut texture = json!({"source": image});
        if self.clamp {
            texture["sampler"] = json!(document.push("samplers", json!({"wrapS": 33071, "wrapT": 33071})));
        }
        let mut slot = json!({"index": document.push("textures", texture)});
        if self.offset != [0.0; 2] || self.scale != [1.0; 2] {
            // OBJ counts v from below, glTF from above.
            let offset = [self.offset[0], 1.0 - self.scale[1] - self.offset[1]];
            slot["extensions"] =
                json!({"KHR_texture_transform": {"offset": numbers(&offset), "scale": numbers(&self.scale)}});
            document.use_extension("KHR_texture_transform");
        }
        slot
    }
}
