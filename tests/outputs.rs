//! Outputs are whole or absent, and never replace an input.

use crate::made::coat_for;
use furrier::asset::{self, Fallback, write, write_coat};
use furrier::data::image::Image8;
use furrier::error::Kind;
use std::path::Path;
use std::process::{Command, Stdio};

/// What the child of these tests writes: a length that no single write call covers, all of one byte.
const LENGTH: usize = 1 << 24;

/// Not a test of its own: run by others as a process that can be killed or starved.
#[test]
fn child_that_writes() {
    let Ok(path) = std::env::var("FURRIER_TEST_WRITES") else { return };
    let straight = std::env::var_os("FURRIER_TEST_STRAIGHT").is_some();
    for round in 0..=u8::MAX {
        let bytes = vec![round; LENGTH];
        if straight {
            std::fs::write(&path, &bytes).expect("written");
        } else if let Err(error) = write::whole(Path::new(&path), &bytes, &[]) {
            println!("refused: {error}");
            return;
        }
    }
}

/// A shell command that runs this test binary's child after `before`.
fn child(before: &str, out: &Path) -> Command {
    let mut command = Command::new("sh");
    let exe = std::env::current_exe().expect("this binary");
    command.arg("-c").arg(format!("{before} exec \"$0\" outputs::child_that_writes --exact --nocapture")).arg(exe);
    command.env("FURRIER_TEST_WRITES", out).stdout(Stdio::piped()).stderr(Stdio::null());
    command
}

fn is_whole(bytes: &[u8]) -> bool {
    bytes.len() == LENGTH && bytes.iter().all(|byte| *byte == bytes[0])
}

#[cfg(unix)]
#[test]
fn a_full_disk_ends_in_an_error_and_leaves_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.glb");
    std::fs::write(&out, b"old").expect("written");
    // A limit on file size stands for the disk: writing fails in the middle.
    let output = child("trap '' XFSZ; ulimit -f 64;", &out).output().expect("it runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("refused: the output cannot be written"), "{text}");
    assert_eq!(std::fs::read(&out).expect("still there"), b"old");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "nothing else is left behind");
}

/// Where in its work a killed process was, by what it left behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moment {
    /// No file of its own.
    Before,
    /// A file with a part of the bytes.
    Within,
    /// A file with all of them, its first or a later one.
    After,
}

/// Sizes of the files in `folder`; one that is gone meanwhile is left out.
fn sizes(folder: &Path) -> Vec<usize> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    entries.filter_map(|entry| entry.metadata().ok()).map(|metadata| metadata.len() as usize).collect()
}

/// Kills children that write, `straight` to the output or as the product does, until three have died at each moment.
/// Gives how many left an output that is neither old nor whole.
///
/// No kill needs to come at a given time: the child is watched, and what it leaves behind says when it died.
pub fn torn_by_kills(straight: bool) -> usize {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.glb");
    let (mut torn, mut seen, mut tries) = (0, [0; 3], 0);
    while let Some(aim) = [Moment::Before, Moment::Within, Moment::After].into_iter().find(|&m| seen[m as usize] < 3) {
        tries += 1;
        assert!(tries < 300, "no child died {aim:?} its write, of {tries}: {seen:?}");
        std::fs::read_dir(folder.path()).expect("a folder").for_each(|entry| {
            std::fs::remove_file(entry.expect("an entry").path()).expect("removed");
        });
        std::fs::write(&out, b"old").expect("written");
        let mut command = child("", &out);
        if straight {
            command.env("FURRIER_TEST_STRAIGHT", "1");
        }
        let mut process = command.spawn().expect("it runs");
        let reached = || match aim {
            Moment::Before => true,
            Moment::Within => sizes(folder.path()).iter().any(|size| (4..LENGTH).contains(size)),
            Moment::After => sizes(folder.path()).contains(&LENGTH),
        };
        while !reached() {
            assert!(process.try_wait().expect("a child").is_none(), "it ended before it was killed {aim:?} its write");
        }
        process.kill().expect("it can be killed");
        process.wait().expect("it ends");
        let left = sizes(folder.path());
        let moment = match () {
            () if left.iter().any(|size| *size != 3 && *size < LENGTH) => Moment::Within,
            () if left.contains(&LENGTH) => Moment::After,
            () => Moment::Before,
        };
        seen[moment as usize] += 1;
        let bytes = std::fs::read(&out).expect("the old file or a new one");
        torn += usize::from(bytes != b"old" && !is_whole(&bytes));
    }
    println!("{seen:?} children died before, within and after a write, {torn} of them left half a file");
    torn
}

#[cfg(unix)]
#[test]
fn a_killed_process_leaves_no_half_written_output() {
    assert_eq!(torn_by_kills(false), 0);
    assert!(!is_whole(&[1, 2]) && !is_whole(&[0; 100]), "the check sees what is not whole");
}

#[test]
fn an_input_is_never_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = folder.path().join("in.glb");
    let bytes = asset::load("sample:plane").expect("a sample").document.to_glb().expect("a GLB");
    std::fs::write(&input, &bytes).expect("written");
    let asset = asset::load(&input.to_string_lossy()).expect("it loads");
    let mut targets = vec![input.clone(), folder.path().join(".").join("in.glb")];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&input, folder.path().join("link.glb")).expect("a link");
        targets.push(folder.path().join("link.glb"));
    }
    for target in targets {
        let error = write_coat(&asset, &coat_for(&asset), Fallback::None, &target).expect_err("it is the input");
        assert_eq!(error.kind, Kind::Output, "{error}");
        assert_eq!(std::fs::read(&input).expect("still there"), bytes);
    }
    for target in [folder.path().to_owned(), folder.path().join("none/out.glb")] {
        assert_eq!(write::check_target(&target, &[]).expect_err("no place for a file").kind, Kind::Output);
    }
    let error = write_coat(&asset, &coat_for(&asset), Fallback::None, &folder.path().join("out.obj"));
    assert_eq!(error.expect_err("not glTF").kind, Kind::Usage);
}

#[test]
fn images_in_files_stay_reachable() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut document = asset::load("sample:plane").expect("a sample").document;
    let mut png = Vec::new();
    let image = Image8 { width: 2, height: 1, channels: 4, pixels: vec![10, 20, 30, 255, 40, 50, 60, 128] };
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    image::ImageEncoder::write_image(encoder, &image.pixels, 2, 1, image::ExtendedColorType::Rgba8).expect("a PNG");
    std::fs::write(folder.path().join("skin tone.png"), &png).expect("written");
    std::fs::write(folder.path().join("data.bin"), &document.binary).expect("written");
    document.json["buffers"][0]["uri"] = "data.bin".into();
    document.json["images"] = serde_json::json!([{"uri": "skin%20tone.png"}]);
    document.json["textures"] = serde_json::json!([{"source": 0}]);
    document.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = serde_json::json!({"index": 0});
    let input = folder.path().join("in.gltf");
    std::fs::write(&input, document.json.to_string()).expect("written");
    let asset = asset::load(&input.to_string_lossy()).expect("it loads");
    assert_eq!(asset.warnings, Vec::<String>::new());
    let elsewhere = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    for (out, kept) in
        [(here.join("a.gltf"), true), (here.join("a.glb"), false), (elsewhere.path().join("b.gltf"), false)]
    {
        write_coat(&asset, &coat_for(&asset), Fallback::None, &out).expect("written");
        let back = asset::load(&out.to_string_lossy()).expect("it loads");
        assert_eq!(back.document.json["images"][0].get("uri").is_some(), kept, "{}", out.display());
        assert_eq!(back.document.decode_image(0).expect("sound").as_ref(), Some(&image), "{}", out.display());
    }
}
