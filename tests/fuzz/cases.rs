//! Whole files to start from, and what is done with meshes.

use super::mutate;
use crate::hostile::{corrupt, unsound};
use crate::made::coat_for;
use furrier::asset::coat::{read_coat, strip, write_stripped};
use furrier::asset::{self, Asset, Document, Fallback, read_document, write_coat};
use furrier::bake::units::Units;
use furrier::bake::{Method, Request, bake};
use furrier::math::hash::Stream;
use furrier::preset::Preset;
use image::{DynamicImage, ImageFormat, RgbaImage};
use std::io::Cursor;
use std::path::Path;
use std::sync::LazyLock;

/// Between the texts of an OBJ and its materials.
pub const CUT: &str = "\n--- a.mtl ---\n";

/// Files that are sound.
pub fn seeds(target: &str) -> Vec<Vec<u8>> {
    let sample = |name: &str| asset::load(&format!("sample:{name}")).expect("a sample");
    let glb = |document: &Document| document.to_glb().expect("a GLB");
    match target {
        "glb" => {
            let mut seeds = vec![glb(&sample("plane").document), glb(&small().document)];
            // Where larger files lie beside the checkout, they have more kinds of things in them.
            let hard = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets/hard");
            let names =
                ["skinned_animated", "morph_targets", "texture_transform", "meshopt", "sparse_accessor", "quantized"];
            seeds.extend(names.iter().filter_map(|name| std::fs::read(hard.join(format!("{name}.glb"))).ok()));
            seeds
        }
        "gltf" => vec![beside(&small().document, "in.bin"), beside(&small().document, "./in%2Ebin")],
        "furry" => {
            let folder = tempfile::tempdir().expect("a folder");
            let coated = |asset: &Asset, name: &str, fallback| {
                let out = folder.path().join(name);
                std::fs::write(folder.path().join("in.glb"), glb(&asset.document)).expect("written");
                let asset = asset::load(&folder.path().join("in.glb").to_string_lossy()).expect("it loads");
                write_coat(&asset, &coat_for(&asset), fallback, &out).expect("written");
                std::fs::read(out).expect("read")
            };
            vec![coated(&small(), "a.glb", Fallback::Shells(2)), coated(&small(), "b.glb", Fallback::None)]
        }
        "obj" => vec![format!("{OBJ}{CUT}{MTL}").into_bytes(), format!("{OBJ}{OBJ}{CUT}").into_bytes()],
        "preset" => Preset::names().filter_map(Preset::source).map(|text| text.as_bytes().to_vec()).collect(),
        "hdr" => vec![hdr(), hdr_in_runs()],
        "exr" => vec![exr()],
        "png" => vec![picture(ImageFormat::Png), picture(ImageFormat::Jpeg), picture(ImageFormat::WebP)],
        _ => Vec::new(),
    }
}

const OBJ: &str = "# a comment\nmtllib a.mtl\no thing\nv 0 0 0\nv 1.0 0 0\nv 1 1e0 0\nv 0 1 0\nv 0 0.5 1\nvt 0 0\nvt 1 0\nvt 1 1\n\
    vn 0 0 1\nusemtl skin\nf 1/1/1 2/2/1 3/3/1 4/1/1\nusemtl other\nf -1//1 -2//1 -3//1\nf 1 2 \\\n 5\ns off\n";
const MTL: &str = "newmtl skin\nKd 0.5 0.4 0.3\nmap_Kd -s 1 1 1 skin.png\nnewmtl other\nKd 1 0 0\nd 0.5\n";

/// A few triangles with texture coordinates, colours and a picture: small enough that a mutation hits what matters.
fn small() -> Asset {
    let mut document = asset::load("sample:plane").expect("a sample").document;
    let view = document.push_view(&picture(ImageFormat::Png), None);
    let image = document.push("images", serde_json::json!({"bufferView": view, "mimeType": "image/png"}));
    let texture = document.push("textures", serde_json::json!({"source": image}));
    document.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = serde_json::json!({"index": texture});
    document.json["accessors"][3]["count"] = serde_json::json!(96);
    Asset::new(document, Vec::new()).expect("it is sound")
}

/// The JSON of a document whose buffer lies beside it.
fn beside(document: &Document, uri: &str) -> Vec<u8> {
    let mut json = document.json.clone();
    json["buffers"][0]["uri"] = serde_json::json!(uri);
    serde_json::to_vec_pretty(&json).expect("JSON")
}

/// The buffer of the glTF files.
pub fn binary() -> &'static [u8] {
    static BINARY: LazyLock<Vec<u8>> = LazyLock::new(|| small().document.binary);
    &BINARY
}

/// A glTF text whose values or whose letters are changed.
pub fn mutated_gltf(seed: &str, stream: &mut Stream) -> Vec<u8> {
    if stream.bits().is_multiple_of(2) {
        return mutate::text(seed, stream);
    }
    let mut json = serde_json::from_str(seed).expect("JSON");
    corrupt(&mut json, stream);
    serde_json::to_vec(&json).expect("JSON")
}

fn picture(format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let byte = |x: u32, y: u32| (x * 37 + y * 11) as u8;
    let image: DynamicImage = match format {
        ImageFormat::Jpeg => image::RgbImage::from_fn(16, 16, |x, y| image::Rgb([byte(x, y), byte(y, x), 90])).into(),
        _ => RgbaImage::from_fn(16, 16, |x, y| image::Rgba([byte(x, y), byte(y, x), 90, 255])).into(),
    };
    image.write_to(&mut bytes, format).expect("encoded");
    bytes.into_inner()
}

/// An environment of 16 × 8 pixels.
fn exr() -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    exr::prelude::write_rgb_file(&path, 16, 8, |x, y| (x as f32, 1.0_f32, y as f32)).expect("written");
    std::fs::read(path).expect("read")
}

/// Radiance pixel by pixel.
fn hdr() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\n# a comment\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n".to_vec();
    (0..16_u8).for_each(|i| bytes.extend([i * 3, 40, 90, 128 + i % 3]));
    bytes
}

/// Radiance in runs of equal bytes, one channel of a row after the other.
fn hdr_in_runs() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 32\n".to_vec();
    for row in 0..4_u8 {
        bytes.extend([2, 2, 0, 32]);
        for channel in 0..4_u8 {
            bytes.extend([128 + 30, 100 + row + channel, 2, 7, 9]);
        }
    }
    bytes
}

/// A GLB whose JSON or whose bytes are changed.
pub fn mutated_glb(seed: &[u8], stream: &mut Stream) -> Vec<u8> {
    if stream.bits().is_multiple_of(2) {
        return mutate::bytes(seed, stream);
    }
    let length = u32::from_le_bytes([seed[12], seed[13], seed[14], seed[15]]) as usize;
    let mut json = serde_json::from_slice(&seed[20..20 + length]).expect("JSON");
    for _ in 0..1 + stream.bits() % 2 {
        corrupt(&mut json, stream);
    }
    let mut text = serde_json::to_vec(&json).expect("JSON");
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = (20 + text.len() + seed.len() - 20 - length) as u32;
    let header = [&seed[..8], &total.to_le_bytes(), &(text.len() as u32).to_le_bytes(), b"JSON"].concat();
    [&header, &text, &seed[20 + length..]].concat()
}

/// Fails where an output, or a piece of one, is in the folder.
pub fn nothing_is_left(folder: &Path) {
    for entry in std::fs::read_dir(folder).expect("the folder") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        assert!(!name.starts_with("out.") && !name.starts_with(".furrier"), "{name} was left behind by a failure");
    }
}

/// Reads a mesh, poses it, and puts a made coat on it; now and then a baked one.
pub fn mesh(bytes: &[u8], name: &str, folder: &Path, case: u64) -> bool {
    let (input, out) = (folder.join(name), folder.join("out.glb"));
    std::fs::write(&input, bytes).expect("written");
    let asset = match asset::load(&input.to_string_lossy()) {
        Ok(asset) => asset,
        Err(error) => {
            assert!(error.file.is_some() && error.found.is_some(), "an error that says too little: {error}");
            return false;
        }
    };
    assert_eq!(unsound(&asset), None);
    let used =
        use_asset(&asset, &out).and_then(|()| if case.is_multiple_of(32) { baked(&input, &out) } else { Ok(()) });
    if let Err(error) = &used {
        assert!(!out.exists(), "written, and then: {error}");
        nothing_is_left(folder);
    } else {
        std::fs::remove_file(&out).expect("it was written");
    }
    used.is_ok()
}

fn use_asset(asset: &Asset, out: &Path) -> furrier::Result<()> {
    let pose = asset.rest_pose()?;
    for part in &asset.parts {
        part.posed(asset, &pose, part.nodes[0], 1.0);
        if let Some(texture) = &part.base_colour.texture {
            asset.document.decode_image(texture.image)?;
        }
    }
    for animation in 0..asset.animation_names().len() {
        asset.pose(animation, 0.3)?;
    }
    asset.subject(1.0, |_, _| 0.01)?;
    write_coat(asset, &coat_for(asset), Fallback::Shells(2), out)?;
    let (read, _) = read_coat(out)?;
    strip(&read.document).map(drop)
}

fn baked(input: &Path, out: &Path) -> furrier::Result<()> {
    std::fs::remove_file(out).expect("the made coat");
    let settings = [
        "shells.texture_size=16",
        "shells.layers=2",
        "fins.texture_width=16",
        "fins.texture_height=16",
        "guard.density_per_cm2=20",
        "undercoat.density_per_cm2=50",
    ];
    let request = Request {
        input: input.to_string_lossy().into_owned(),
        reading: Default::default(),
        out: out.to_owned(),
        preset: Preset::load("plush")?.with_settings(&settings.map(str::to_owned))?,
        presets: vec![],
        materials: vec![],
        units: Units::Auto,
        method: Method::Lapped,
        seed: 0,
        fallback: Fallback::Shells(2),
        judge: false,
        cache: None,
        draft: false,
    };
    bake(&request, &mut |_| {}).map(drop)
}

/// Reads a file with a coat, and takes it off.
pub fn furry(bytes: &[u8], folder: &Path) -> bool {
    let (input, out) = (folder.join("in.glb"), folder.join("out.glb"));
    std::fs::write(&input, bytes).expect("written");
    let coat = read_coat(&input);
    let stripped =
        read_document(&input).and_then(|(document, _)| strip(&document)).and_then(|bare| write_stripped(bare, &out));
    match &stripped {
        // What comes off leaves something that can be read, if it could be read before.
        Ok(_) => {
            let (before, after) = (asset::load(&input.to_string_lossy()), asset::load(&out.to_string_lossy()));
            assert!(before.is_err() || after.is_ok(), "{:?}", after.err());
            std::fs::remove_file(&out).expect("it was written");
        }
        Err(_) => nothing_is_left(folder),
    }
    coat.is_ok() && stripped.is_ok()
}
