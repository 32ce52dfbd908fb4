//! Folders, files and `furrier.toml`.

use super::{furrier, json, said, succeeds, triangles};
use furrier::bake::recipe::Choices;
use furrier::batch::key::Key;
use furrier::batch::library::manifest::Manifest;
use furrier::batch::library::{open, starter};
use furrier::batch::plan::Plan;
use std::path::{Path, PathBuf};

fn plan_of(folder: &Path, toml: &str) -> furrier::Result<Plan> {
    std::fs::write(folder.join("furrier.toml"), toml).unwrap();
    open(&[folder.to_owned()], &Choices::default(), None, false)
}

fn names(plan: &Plan) -> Vec<(String, String, usize)> {
    let text = |path: &Path| path.to_string_lossy().replace('\\', "/");
    plan.entries.iter().map(|entry| (text(&entry.input), text(&entry.output), entry.recipe)).collect()
}

#[test]
fn rules_go_over_defaults_and_later_ones_over_earlier_ones() {
    let folder = triangles(4);
    let plan = plan_of(
        folder.path(),
        r#"
            [defaults]
            presets = ["mink"]
            set = ["guard.taper=0.5"]
            output = "{dir}/furry/{name}_{ext}.glb"
            [[rules]]
            files = ["**/*.obj"]
            except = ["t3.*"]
            [[rules]]
            files = ["sub/**"]
            presets = ["sheep"]
            set = ["guard.taper=0.25"]
            seed = 7
            [[rules]]
            files = ["t1.obj"]
            skip = true
        "#,
    )
    .unwrap();
    let expected = [("sub/t2.obj", "sub/furry/t2_obj.glb", 0), ("t0.obj", "furry/t0_obj.glb", 1)];
    assert_eq!(names(&plan), expected.map(|(a, b, c)| (a.to_owned(), b.to_owned(), c)));
    let [sub, top] = &plan.recipes[..] else { panic!("{} recipes", plan.recipes.len()) };
    assert_eq!((sub.preset.name.as_str(), sub.preset.guard.taper, sub.seed), ("sheep", 0.25, 7));
    assert_eq!((top.preset.name.as_str(), top.preset.guard.taper, top.seed), ("mink", 0.5, 0));
}

#[test]
fn what_cannot_be_is_refused_and_names_the_file() {
    let folder = triangles(2);
    for (toml, said) in [
        ("[defaults]\npreset = \"fox\"\n", "unknown field `preset`"),
        ("[[rules]]\nfiles = [\"*\"]\nlayerz = 3\n", "unknown field `layerz`"),
        ("[[rules]]\nseed = 3\n", "without files"),
        ("[defaults]\nfiles = [\"*\"]\n", "files in [defaults]"),
        ("[[rules]]\nfiles = [\"[\"]\n", "a glob cannot be read"),
        ("[defaults]\noutput = \"furry/all.glb\"\n", "all assets would have the same output"),
        ("[defaults]\noutput = \"furry/{path}.obj\"\n", "outputs are glTF files"),
        ("[defaults]\noutput = \"furry/{stem}.glb\"\n", "names something that is not known"),
        ("[defaults]\npresets = [\"foxx\"]\n", "there is no such preset"),
        ("[defaults]\nfallback = \"some\"\n", "expected `none`"),
        ("[defaults]\nup = \"w\"\n", "expected x, y, z"),
        ("[defaults]\nup = \"z\"\nforward = \"-z\"\n", "along the same axis"),
        ("[defaults]\nset = [\"guard.length.mm=-1\"]\n", "out of range"),
        ("[[rules]]\nfiles = [\"*.fbx\"]\n", "nothing to bake"),
    ] {
        let error = plan_of(folder.path(), toml).expect_err(toml);
        let text = error.to_string();
        assert!(text.contains(said) && text.contains("furrier.toml"), "{toml}: {text}");
    }
    std::fs::copy(folder.path().join("t0.obj"), folder.path().join("t0.glb")).unwrap();
    let error = plan_of(folder.path(), "").expect_err("two t0");
    assert!(error.to_string().contains("two assets have the same output"), "{error}");
}

#[test]
fn a_library_says_of_axes_and_levels_what_bake_does() {
    let folder = triangles(1);
    let plan = plan_of(folder.path(), "[defaults]\nup = \"z\"\nforward = \"-x\"\nlods = true\n").unwrap();
    let axis = |text: &str| Some(text.parse().unwrap());
    let chosen = Choices { up: axis("z"), forward: axis("-x"), lods: true, ..Choices::default() };
    assert_eq!(plan.recipes, [chosen.recipe().unwrap()]);
    let request = plan.recipes[0].request("a.obj", Path::new("a.glb"), false);
    assert!(request.reading.lods && request.reading.upright.is_some());
    let file = folder.path().join("plan.jsonl");
    plan.write(&file).unwrap();
    assert_eq!(Plan::read(&file).unwrap(), plan);
    // They are part of what an output was made from; where nothing is said of them, it is what it was.
    let value = Key::of(&plan.recipes[0]).unwrap().value;
    assert_eq!((&value["upright"]["forward"], &value["lods"]), (&serde_json::json!("-x"), &serde_json::json!(true)));
    let plain = Key::of(&Choices::default().recipe().unwrap()).unwrap().value;
    assert!(plain.get("upright").is_none() && plain.get("lods").is_none());
}

#[test]
fn outputs_are_no_inputs() {
    let folder = triangles(1);
    let toml = "[defaults]\noutput = \"{path}_furry.glb\"\n";
    std::fs::write(folder.path().join("t0_furry.glb"), "an output").unwrap();
    assert_eq!(names(&plan_of(folder.path(), toml).unwrap()).len(), 1);
    let error = plan_of(folder.path(), "[defaults]\noutput = \"{path}.glb\"\n[[rules]]\nfiles = [\"*.glb\"]\n");
    assert!(error.expect_err("itself").to_string().contains("overwrite the input"));
}

#[test]
fn the_starter_is_what_is_done_without_it() {
    let folder = triangles(3);
    let without = open(&[folder.path().to_owned()], &Choices::default(), None, false).unwrap();
    let mut command = furrier(&["batch", "init"]);
    succeeds(command.arg(folder.path()));
    let again = furrier(&["batch", "init"]).arg(folder.path()).output().unwrap();
    assert_eq!(again.status.code(), Some(2), "{}", said(&again));
    let with = open(&[folder.path().to_owned()], &Choices::default(), None, false).unwrap();
    assert_eq!((names(&with), &with.recipes), (names(&without), &without.recipes));
    // Every key that is commented out is one.
    let uncommented: Vec<&str> = starter::TEXT
        .lines()
        .map(|line| {
            line.strip_prefix("# ")
                .filter(|key| key.split([' ', '[']).nth(1) == Some("=") || key.starts_with("[["))
                .unwrap_or(line)
        })
        .collect();
    let path = folder.path().join("all.toml");
    std::fs::write(&path, uncommented.join("\n")).unwrap();
    let all = Manifest::read(&path).unwrap();
    assert_eq!((all.rules.len(), all.defaults.seed, all.defaults.uv_set), (3, Some(0), Some(0)));
}

#[test]
fn files_go_to_one_folder_and_choices_do_not_mix_with_a_manifest() {
    let folder = triangles(3);
    let out = folder.path().join("out");
    let files: Vec<PathBuf> = ["t0.obj", "sub/t2.obj"].map(|name| folder.path().join(name)).to_vec();
    let mut command = furrier(&["batch"]);
    let (code, value) = json(command.args(&files).args(super::small()).arg("-o").arg(&out));
    assert_eq!((code, value["baked"].as_u64()), (0, Some(2)), "{value}");
    assert!(out.join("t0.glb").is_file() && out.join("t2.glb").is_file());
    succeeds(furrier(&["batch", "init"]).arg(folder.path()));
    let refused = furrier(&["batch"]).arg(folder.path()).args(["--preset", "fox"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    let several = furrier(&["bake"]).args(&files).arg("-o").arg(&out).output().unwrap();
    assert_eq!(several.status.code(), Some(2));
    assert!(said(&several).contains("furrier batch"), "{}", said(&several));
}
