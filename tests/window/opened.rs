//! The real window, driven by a script.

use crate::common::furrier_path;
use crate::surface::Server;
use std::path::Path;
use std::process::{Command, Output};

/// A map of light, brighter above: Radiance's format without run lengths.
fn sky() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".to_vec();
    for row in 0..4_u8 {
        for _ in 0..8 {
            bytes.extend([60 - row * 10, 60, 80 + row * 20, 130]);
        }
    }
    bytes
}

fn view(display: &str, folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(furrier_path());
    command.current_dir(folder).env("XDG_CONFIG_HOME", folder).env_remove("WAYLAND_DISPLAY").env("DISPLAY", display);
    command.arg("view").args(arguments).output().unwrap()
}

/// The mean colour of a part of a picture, by its left, top, right and bottom in hundredths.
fn mean(picture: &image::RgbaImage, [left, top, right, bottom]: [u32; 4]) -> [f64; 3] {
    let (width, height) = picture.dimensions();
    let mut sum = [0.0; 3];
    let mut count = 0.0;
    for y in height * top / 100..height * bottom / 100 {
        for x in width * left / 100..width * right / 100 {
            let pixel = picture.get_pixel(x, y);
            (0..3).for_each(|i| sum[i] += f64::from(pixel[i]));
            count += 1.0;
        }
    }
    sum.map(|sum| sum / count)
}

#[test]
fn a_script_resizes_drops_plays_takes_pictures_and_closes() {
    let Some(server) = Server::start("1000x800x24") else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sky.hdr"), sky()).unwrap();
    std::fs::write(folder.path().join("broken.glb"), b"glTF, but no more").unwrap();
    let baked = Command::new(furrier_path())
        .current_dir(folder.path())
        .args(["-q", "bake", "sample:creature", "-o", "furry.glb", "--texture-size", "32", "--layers", "6"])
        .output()
        .unwrap();
    assert!(baked.status.success(), "{}", String::from_utf8_lossy(&baked.stderr));
    let script = "resize 640 480\nwait\npicture wall.png\ndrop sky.hdr\nwait\npicture sky.png\nset animation 0\nset play on\n\
                  wait 0.5\nset play off\nwait\npicture bent.png\ndrop broken.glb\nwait 1\npicture broken.png\nquit\n";
    std::fs::write(folder.path().join("script"), script).unwrap();
    let done = view(server.name.to_str().unwrap(), folder.path(), &["furry.glb", "--script", "script"]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let picture = |name: &str| image::open(folder.path().join(name)).unwrap().to_rgba8();
    let [wall, sky, bent, broken] = ["wall.png", "sky.png", "bent.png", "broken.png"].map(picture);
    assert_eq!(wall.dimensions(), (640, 480));
    // The wall is grey, the sky is not.
    let corner = [1, 2, 12, 10];
    let [r, _, b] = mean(&wall, corner);
    let grey = b - r;
    let [r, _, b] = mean(&sky, corner);
    assert!(grey.abs() < 20.0 && b - r > grey + 20.0, "the wall {grey}, the sky {r} {b}");
    assert_ne!(sky, bent, "the animation moves it");
    // What cannot be read is told, and the asset stays.
    let middle = [15, 20, 40, 60];
    let apart = mean(&bent, middle).iter().zip(mean(&broken, middle)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 25.0, "{apart}");
}

#[test]
fn without_a_display_it_is_said_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let done = view(":4242", folder.path(), &["sample:sphere"]);
    assert_eq!(done.status.code(), Some(5));
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(said.contains("no window can be opened") && said.contains("--screenshot"), "{said}");
}

#[test]
fn a_script_that_asks_for_what_there_is_not_fails() {
    let Some(server) = Server::start("1000x800x24") else { return };
    let folder = tempfile::tempdir().unwrap();
    let display = server.name.to_str().unwrap();
    std::fs::write(folder.path().join("script"), "set warmth 3\n").unwrap();
    let done = view(display, folder.path(), &["sample:sphere", "--script", "script"]);
    assert_eq!(done.status.code(), Some(2));
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(said.contains("warmth") && said.contains("exposure"), "{said}");
}
