//! Error against time: the front, the table, the plot, and a small sweep through the real binary.

use crate::common::furrier_path;
use assert_cmd::Command;
use furrier::report::{Point, mark_front, plot, table};

fn point(sweep: &str, ms: f64, flip: f64) -> Point {
    Point {
        sweep: sweep.into(),
        value: 2.5,
        ms,
        bytes: 1,
        flip,
        flip_p95: flip,
        rel_mse: flip,
        bias: -0.01,
        steps: 3,
        fragments: 4,
        pareto: false,
        defaults: (sweep == "preview").then_some("preview"),
    }
}

fn points() -> Vec<Point> {
    let mut points = vec![
        point("preview", 10.0, 0.05),
        point("preview: depth, \"d\"", 20.0, 0.05),
        point("final: layers", 40.0, 0.01),
        point("final: layers", 40.0, 0.01),
        point("final: <passes>", 5.0, 0.5),
        point("final: layers", 50.0, 0.0),
    ];
    mark_front(&mut points);
    points
}

#[test]
fn the_front_is_what_nothing_beats() {
    let marked: Vec<bool> = points().iter().map(|p| p.pareto).collect();
    assert_eq!(marked, [true, false, true, true, true, true]);
}

#[test]
fn a_table_has_a_line_per_point_and_quotes_what_it_must() {
    let text = table::csv(&points());
    let lines: Vec<&str> = text.split_terminator("\r\n").collect();
    assert_eq!(lines.len(), 7);
    assert!(lines[2].starts_with("\"preview: depth, \"\"d\"\"\",2.5,20.000,"));
    let columns = lines[0].split(',').count();
    assert!(lines.iter().skip(3).all(|line| line.split(',').count() == columns));
}

#[test]
fn a_plot_shows_every_point_and_is_well_formed() {
    let text = plot::svg("a < b & c", "FLIP", &points());
    assert_eq!(text.matches("<circle").count(), 5 + 3, "points, and controls in the legend");
    assert_eq!(text.matches("font-weight=\"bold\">preview").count(), 1);
    assert!(text.contains("a &lt; b &amp; c") && text.contains("&lt;passes&gt;") && !text.contains("NaN"));
    // Every tag is closed in its turn.
    let mut open = Vec::new();
    for tag in text.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').expect("a closed tag");
        let name = tag.trim_start_matches('/').split([' ', '/', '\n']).next().unwrap();
        match (tag.starts_with('/'), tag.ends_with('/')) {
            (true, _) => assert_eq!(open.pop(), Some(name)),
            (false, false) => open.push(name),
            (false, true) => {}
        }
    }
    assert!(open.is_empty());
    assert!(plot::svg("none", "FLIP", &[]).ends_with("</svg>\n"));
}

/// Little hair in large clumps: quick to draw.
pub const SPARSE: [&str; 6] = [
    "--set",
    "guard.density_per_cm2=4",
    "--set",
    "undercoat.density_per_cm2=100",
    "--set",
    "undercoat.shape.clump={ spacing_mm = 40, strength = 0.35 }",
];

#[test]
fn a_sweep_writes_its_four_files() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = |name: &str| {
        let mut command = Command::new(furrier_path());
        command.args(["report", "render", "sample:plane", "--size", "16x16", "--repeats", "1", "--transparent"]);
        command.args(SPARSE);
        command.arg("-o").arg(folder.path().join(name)).assert()
    };
    sweep("out.json").success();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let report: serde_json::Value = serde_json::from_str(&read("out.json")).unwrap();
    let points = report["points"].as_array().unwrap();
    assert_eq!(report["schema_version"], 1);
    assert_eq!(report["yardstick"]["name"], "the finest setting");
    let defaults: Vec<&str> = points.iter().filter_map(|p| p["defaults"].as_str()).collect();
    assert_eq!(defaults, ["preview", "final"]);
    assert!(points.len() > 40 && points.iter().any(|p| p["pareto"] == true));
    assert_eq!(read("out.csv").lines().count(), points.len() + 1);
    assert!(read("out.svg").starts_with("<svg"));
    let drawn = image::open(folder.path().join("out.png")).unwrap().to_rgba8();
    let covered = drawn.pixels().filter(|p| p.0[3] > 128).count();
    assert!(drawn.dimensions() == (16, 16) && (10..240).contains(&covered), "{covered} pixels");
    sweep("out.txt").code(2);
    // Against a picture of one's own: of the view it is close to, of another size it is refused.
    let picture = |size: &str| {
        let path = folder.path().join(format!("{size}.exr"));
        let mut command = Command::new(furrier_path());
        command.args(["render", "sample:plane", "--preset", "mink", "--size", size, "--quality", "final"]);
        command.args(SPARSE);
        command.arg("-o").arg(&path).assert().success();
        path
    };
    let [own, other] = ["16x16", "8x8"].map(picture);
    for path in [&own, &other] {
        let mut command = Command::new(furrier_path());
        command
            .args(["report", "render", "sample:plane", "--size", "16x16", "--repeats", "1", "--reference"])
            .arg(path);
        command.args(SPARSE);
        let assert = command.arg("-o").arg(folder.path().join("out.json")).assert();
        if path == &own {
            assert.success()
        } else {
            assert.code(3)
        };
    }
    let report: serde_json::Value = serde_json::from_str(&read("out.json")).unwrap();
    assert_eq!(report["points"][1]["flip"], 0.0, "final against itself");
    [own, other].iter().for_each(|path| std::fs::remove_file(path).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
}
