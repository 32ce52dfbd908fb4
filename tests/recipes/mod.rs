//! The recipes: every command of the page runs, on small pictures and with little hair, and leaves what it says.

mod figure;
mod paint;

use crate::common::{furrier_path, skipped};
use std::path::{Path, PathBuf};
use std::process::Command;

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

/// Headings of the page and the commands below each.
fn recipes() -> Vec<(String, String)> {
    let page = std::fs::read_to_string(docs().join("recipes.md")).expect("the page");
    let mut recipes: Vec<(String, String)> = Vec::new();
    let mut in_block = false;
    for line in page.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            recipes.push((heading.to_owned(), String::new()));
        } else if line.starts_with("```") {
            in_block = line == "```sh";
        } else if in_block {
            let (_, commands) = recipes.last_mut().expect("commands stand below a heading");
            *commands += line;
            commands.push('\n');
        }
    }
    recipes
}

/// The binary, but with small textures, little hair and small pictures, whatever the page asks for.
const SMALLER: &str = r#"
furrier() {
  local small=() previous=
  for word in "$@"; do
    case "$previous" in
      --size) word=96x80 ;;
      --layers) word=4 ;;
      --texture-size) word=16 ;;
    esac
    small+=("$word")
    previous=$word
  done
  case "$1" in
    bake | render)
      small+=(--set shells.layers=4 --set shells.texture_size=16 --set fins.texture_width=16 --set fins.texture_height=16
        --set guard.density_per_cm2=40 --set undercoat.density_per_cm2=200) ;;
  esac
  command "$FURRIER" -q "${small[@]}"
}
set -euo pipefail
"#;

#[test]
fn every_recipe_runs() {
    if furrier::gpu::adapters().is_empty() {
        return skipped("no graphics adapter to view what the recipes bake");
    }
    let folder = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(docs().join("recipes")).expect("the files of the recipes") {
        let path = entry.unwrap().path();
        std::fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    let recipes = recipes();
    assert!(recipes.len() >= 6, "{} recipes", recipes.len());
    for (heading, commands) in recipes {
        assert!(commands.contains("furrier "), "{heading} has no command");
        let output = Command::new("bash")
            .args(["-c", &format!("{SMALLER}{commands}")])
            .env("FURRIER", furrier_path())
            .current_dir(folder.path())
            .output()
            .expect("bash runs");
        assert!(output.status.success(), "{heading}\n{commands}\n{}", String::from_utf8_lossy(&output.stderr));
        for picture in commands.split_whitespace().filter(|word| word.ends_with(".png") && !word.contains('=')) {
            let image =
                image::open(folder.path().join(picture)).unwrap_or_else(|e| panic!("{heading}: {picture}: {e}"));
            let image = image.to_rgb8();
            let first = image.get_pixel(0, 0);
            let other = image.pixels().filter(|pixel| *pixel != first).count();
            assert!(other > image.pixels().len() / 50, "{heading}: {picture} shows nothing");
        }
    }
}

/// Compares a file of the recipes with what the code makes of it; `FURRIER_UPDATE=1 cargo test --release recipes` writes them.
fn keep(name: &str, made: &[u8], alike: impl Fn(&[u8], &[u8]) -> bool) {
    let path = docs().join("recipes").join(name);
    if std::env::var_os("FURRIER_UPDATE").is_some() {
        std::fs::write(&path, made).unwrap();
    }
    let kept = std::fs::read(&path).unwrap_or_default();
    assert!(
        alike(&kept, made),
        "docs/recipes/{name} is not current; FURRIER_UPDATE=1 cargo test --release recipes writes it"
    );
}

#[test]
fn the_files_of_the_recipes_are_current() {
    let pixels =
        |bytes: &[u8]| image::load_from_memory(bytes).map(|image| image.to_rgb8().into_raw()).unwrap_or_default();
    for (name, image) in paint::paintings() {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        keep(name, &bytes.into_inner(), |kept, made| pixels(kept) == pixels(made));
    }
    for (name, text) in figure::files() {
        keep(name, text.as_bytes(), |kept, made| kept == made);
    }
}
