//! OBJ and MTL files as programs write them.

use super::{close, hair_colour, load, png, put, says};
use furrier::asset;
use furrier::math::Vec3;
use furrier::math::hash::Stream;
use std::path::Path;

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.05, 0.5, 0.08];

/// A square of 10 cm in two triangles; lines to go before it, and how its corners are named.
fn square(before: &str, corners: [&str; 4]) -> String {
    let [a, b, c, d] = corners;
    format!(
        "{before}v 0 0 0\nv 0.1 0 0\nv 0.1 0 -0.1\nv 0 0 -0.1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl fur\nf {a} {b} {c}\nf {a} {c} {d}\n"
    )
}

const MAPPED: [&str; 4] = ["1/1", "2/2", "3/3", "4/4"];

/// Colour of the hair on a square whose OBJ begins with `before`, beside material files.
fn colour(folder: &Path, before: &str, files: &[(&str, &str)]) -> Vec3 {
    files.iter().for_each(|(name, text)| drop(put(folder, name, text)));
    hair_colour(&put(folder, "square.obj", square(before, MAPPED)))
}

#[test]
fn colours_are_read_however_they_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    put(folder, "red.png", png([255, 0, 0]));
    put(folder, "textures/red.png", png([255, 0, 0]));
    put(folder, "my bear #2.png", png([255, 0, 0]));
    let red = "newmtl fur\nKd 1 1 1\nmap_Kd red.png\n";
    let named = |map: &str| format!("newmtl fur\nmap_Kd {map}\n");
    let paths: Vec<(String, &str)> = [
        ("textures\\red.png", "a separator of Windows"),
        ("C:\\work\\bears\\red.png", "a folder of another machine"),
        ("/home/someone/RED.PNG", "letters in another case"),
        ("\"red.png\"", "quotes"),
        ("my bear #2.png", "a name with spaces and a number sign"),
        ("-blendu on -clamp on -s 2 2 2 -o 0.5 0 -bm 0.2 red.png", "options"),
        ("-mm 0 1 -imfchan l my bear #2.png", "options before a name with spaces"),
    ]
    .map(|(map, what)| (named(map), what))
    .to_vec();
    let mut cases: Vec<(&str, String, String, [f32; 3])> =
        paths.into_iter().map(|(mtl, what)| (what, "mtllib m.mtl\n".to_owned(), mtl, RED)).collect();
    let case = |what, before: &str, mtl: &str, colour| (what, before.to_owned(), mtl.to_owned(), colour);
    cases.extend([
        case("plain", "mtllib m.mtl\n", red, RED),
        case("a byte order mark", "\u{feff}mtllib m.mtl\n", &format!("\u{feff}{red}"), RED),
        case("tabs", "mtllib\tm.mtl\n", "newmtl\tfur\n\tKd\t1 1 1\n\tmap_Kd\tred.png\n", RED),
        case("carriage returns", "mtllib m.mtl\r\n", &red.replace('\n', "\r\n"), RED),
        case("carriage returns alone", "mtllib m.mtl\n", &red.replace('\n', "\r"), RED),
        case("a comment behind", "mtllib m.mtl # colours\n", red, RED),
        case("two files in a line", "mtllib none.mtl m.mtl\n", red, RED),
        case("two lines", "mtllib none.mtl\nmtllib m.mtl\n", red, RED),
        case("parts of 255", "mtllib m.mtl\n", "newmtl fur\nKd 51 102 255\n", [0.2, 0.4, 1.0]),
        case("one number alone", "mtllib m.mtl\n", "newmtl fur\nKd 0.25\n", [0.25; 3]),
        case("a colour alone", "mtllib m.mtl\n", "newmtl fur\nKa 0 0 0\nKd 0.05 0.5 0.08\nillum 1\n", GREEN),
        case("an image that is not there", "mtllib m.mtl\n", "newmtl fur\nKd 0.05 0.5 0.08\nmap_Kd no.png\n", GREEN),
        case("an image of another kind", "mtllib m.mtl\n", "newmtl fur\nKd 0.05 0.5 0.08\nmap_Kd m.mtl\n", GREEN),
    ]);
    for (what, before, mtl, expected) in cases {
        let found = colour(folder, &before, &[("m.mtl", &mtl)]);
        assert!(close(found, expected), "{what}: {found}");
    }
    let found = colour(folder, "mtllib my bear.mtl\n", &[("my bear.mtl", red)]);
    assert!(close(found, RED), "a material file with a space: {found}");
    put(folder, "mats/a.mtl", named("own.png"));
    put(folder, "mats/own.png", png([255, 0, 0]));
    let found = colour(folder, "mtllib mats\\a.mtl\n", &[]);
    assert!(close(found, RED), "an image beside its material file: {found}");
    // UTF-16, as editors on Windows save it.
    let wide: Vec<u8> = square("\u{feff}mtllib m.mtl\n", MAPPED).encode_utf16().flat_map(u16::to_le_bytes).collect();
    put(folder, "m.mtl", red);
    let found = hair_colour(&put(folder, "wide.obj", wide));
    assert!(close(found, RED), "UTF-16: {found}");
}

#[test]
fn what_is_not_read_of_materials_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (before, mtl, words) in [
        ("mtllib none.mtl\n", "", &["none.mtl", "not in the input's folder"][..]),
        ("mtllib two words.mtl\n", "", &["two words.mtl"]),
        ("mtllib m.mtl\n", "newmtl other\nKd 1 0 0\n", &["\"fur\"", "none of the material files"]),
        ("mtllib m.mtl\n", "newmtl fur\nmap_Ka red.png\n", &["\"fur\"", "map_ka red.png", "white"]),
        ("mtllib m.mtl\n", "newmtl fur\nKd 12 128 20\n", &["\"fur\"", "Kd 12 128 20", "parts of 255"]),
        ("mtllib m.mtl\n", "newmtl fur\nKd spectral ident.rfl\n", &["\"fur\"", "spectral"]),
        ("mtllib m.mtl\n", "newmtl fur\nmap_Kd no.png\n", &["\"fur\"", "no.png"]),
        ("mtllib m.mtl\n", "newmtl fur\nmap_Kd m.mtl\n", &["\"fur\"", "neither PNG, JPEG nor WebP"]),
    ] {
        put(folder, "m.mtl", mtl);
        let asset = load(&put(folder, "square.obj", square(before, MAPPED)));
        assert!(says(&asset.warnings, words), "{before}{mtl}: {:?}", asset.warnings);
    }
    // Nothing is said where nothing is wrong.
    put(folder, "m.mtl", "newmtl fur\nKd 1 0 0\n");
    let asset = load(&put(folder, "square.obj", square("mtllib m.mtl\n", MAPPED)));
    assert_eq!(asset.warnings, Vec::<String>::new());
}

#[test]
fn a_sign_at_the_end_of_a_name_or_comment_swallows_no_line() {
    let folder = tempfile::tempdir().unwrap();
    let plain = load(&put(folder.path(), "plain.obj", square("", MAPPED)));
    for before in ["# exported from C:\\scenes\\bear\\\n", "o C:\\bear\\\n", "g body\\\n", "mtllib C:\\bear\\\n"] {
        let asset = load(&put(folder.path(), "odd.obj", square(before, MAPPED)));
        assert_eq!(asset.parts[0].stored.positions, plain.parts[0].stored.positions, "{before}");
    }
    // Numbers do go on in the next line, and comments end them.
    let text = square("", MAPPED).replace("f 1/1 2/2 3/3", "f 1/1 \\\n2/2 3/3 # C:\\bear\\");
    let asset = load(&put(folder.path(), "odd.obj", text));
    assert_eq!(asset.parts[0].stored.positions, plain.parts[0].stored.positions);
    // Names keep what looks like a comment.
    let asset = load(&put(folder.path(), "odd.obj", square("", MAPPED).replace("usemtl fur", "usemtl Material #25")));
    assert_eq!(asset.parts[0].material_name, "Material #25");
}

#[test]
fn faces_without_texture_coordinates_take_a_colour_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    // Left half red, right half blue; the face that lacks coordinates hangs on the left.
    let mut halves = image::RgbImage::from_pixel(8, 8, image::Rgb([255, 0, 0]));
    (4..8).for_each(|x| (0..8).for_each(|y| halves.put_pixel(x, y, image::Rgb([0, 0, 255]))));
    halves.save(folder.path().join("halves.png")).unwrap();
    put(folder.path(), "m.mtl", "newmtl fur\nmap_Kd halves.png\n");
    let text = "mtllib m.mtl\nv 0 0 0\nv 0.1 0 0\nv 0.1 0 -0.1\nv 0 0 -0.1\nv 0.2 0 0\nvt 0.2 0.5\nvt 0.3 0.5\nusemtl fur\n\
                f 1/1 2/1 3/2\nf 1/1 3/2 4/2\nf 2 5 3\n";
    let path = put(folder.path(), "mixed.obj", text);
    let asset = load(&path);
    assert!(says(&asset.warnings, &["\"fur\"", "3 of 7 vertices have no texture coordinate"]), "{:?}", asset.warnings);
    assert_eq!(asset.parts[0].stored.triangles.len(), 3);
    assert!(close(hair_colour(&path), RED));
    // Where no face has any, the image cannot be laid on, and that is said.
    let path = put(folder.path(), "none.obj", square("mtllib m.mtl\n", ["1", "2", "3", "4"]));
    assert!(says(&load(&path).warnings, &["\"fur\"", "no texture coordinates"]));
}

#[test]
fn options_of_images_move_them() {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), "red.png", png([255, 0, 0]));
    put(folder.path(), "m.mtl", "newmtl fur\nmap_Kd -s 2 3 1 -o 0.25 0.5 -clamp on red.png\n");
    let asset = load(&put(folder.path(), "square.obj", square("mtllib m.mtl\n", MAPPED)));
    let texture = asset.parts[0].base_colour.texture.as_ref().expect("a texture");
    assert_eq!(texture.wrap, [furrier::data::texture::Wrap::Clamp; 2]);
    // OBJ: where (u, v), counted from below, is read at (2 u + 0.25, 3 v + 0.5).
    for (u, v) in [(0.1_f32, 0.2_f32), (0.7, 0.4)] {
        let read = texture.transformed(furrier::math::Vec2::new(u, 1.0 - v));
        let expected = furrier::math::Vec2::new(2.0 * u + 0.25, 1.0 - (3.0 * v + 0.5));
        assert!((read - expected).length() < 1e-6, "{read} {expected}");
    }
    assert_eq!(asset.document.json["extensionsUsed"], serde_json::json!(["KHR_texture_transform"]));
}

#[test]
fn colours_behind_vertices_are_those_of_scans() {
    let folder = tempfile::tempdir().unwrap();
    for (scale, name) in [(1.0, "unit.obj"), (255.0, "bytes.obj")] {
        let colour = format!(" {} {} 0", 0.5 * scale, scale);
        let text = square("", MAPPED).replace("v 0.1 0 0", &format!("v 0.1 0 0{colour}"));
        let text = ["v 0 0 0\n", "v 0.1 0 -0.1\n", "v 0 0 -0.1\n"]
            .iter()
            .fold(text, |text, v| text.replacen(v, &format!("{}{colour}\n", v.trim_end()), 1));
        let found = hair_colour(&put(folder.path(), name, text));
        assert!(close(found, [0.2140, 1.0, 0.0]), "{name}: {found}");
    }
}

#[test]
fn mutated_meshes_and_materials_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), "red.png", png([255, 0, 0]));
    let mesh = square("mtllib m.mtl\n# a comment\nv 1 2 3 0.1 0.2 0.3\n", MAPPED);
    let materials = "newmtl fur\nKd 0.1 0.2 0.3\nd 0.5\nmap_Kd -s 2 2 -o 0.5 -clamp on red.png\nnewmtl\tother\nKd 1\n";
    let odd = [
        "-1",
        "99999999999",
        "nan",
        "1e39",
        "\\",
        "#",
        "/",
        "//",
        "\u{feff}",
        "\0",
        "\r",
        "-s",
        "f",
        "v",
        "usemtl",
        "\u{e9}",
    ];
    let mutated = |text: &str, stream: &mut Stream| -> Vec<u8> {
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..1 + stream.bits() % 4 {
            let at = stream.bits() as usize % (bytes.len() + 1);
            let end = (at + stream.bits() as usize % 4).min(bytes.len());
            match stream.bits() % 3 {
                0 => drop(bytes.splice(at..end, odd[stream.bits() as usize % odd.len()].bytes())),
                1 => bytes.truncate(at),
                _ => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte = stream.bits() as u8),
            }
        }
        bytes
    };
    let mut accepted = 0;
    for seed in 0..400 {
        let mut stream = Stream::new(seed);
        put(folder.path(), "m.mtl", mutated(materials, &mut stream));
        let text = if seed % 2 == 0 { mutated(&mesh, &mut stream) } else { mesh.clone().into_bytes() };
        let path = put(folder.path(), "mutated.obj", text);
        let result = std::panic::catch_unwind(|| asset::load(&path.to_string_lossy()));
        match result.unwrap_or_else(|_| panic!("seed {seed} panics")) {
            Ok(asset) => {
                accepted += 1;
                // What is read can be written.
                asset.document.to_glb().unwrap();
                assert!(asset.parts.iter().all(|part| part.mesh(1.0).is_ok()), "seed {seed}");
            }
            Err(error) => assert!(error.file.is_some() && error.field.is_some(), "seed {seed}: {error}"),
        }
    }
    assert!((100..400).contains(&accepted), "{accepted} of 400 are accepted");
}
