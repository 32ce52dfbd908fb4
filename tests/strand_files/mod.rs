//! Guard hairs in files for other programs, read back by the formats' own rules.

mod cyhair;
mod usda;

use crate::common::{furrier_path, shared};
use crate::scenes;
use assert_cmd::Command;
use furrier::asset::strands::{Export, Format, encode};
use furrier::data::strands::Strands;
use furrier::math::{DMat3, DVec3, Vec3};

fn some_hair() -> Strands {
    let (mut guard, undercoat) = scenes::mink();
    guard.density_per_cm2 = 2.0;
    scenes::Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3).guard
}

fn export(strands: &Strands) -> Export<'_> {
    Export {
        strands,
        origin_m: DVec3::new(1000.0, -2.0, 0.5),
        metres_per_unit: 0.01,
        file_from_world: DMat3::IDENTITY,
        name: "2 bent skins",
    }
}

/// A point of the hair in the file's units.
fn in_units(export: &Export<'_>, i: usize) -> DVec3 {
    (export.strands.points_m[i].as_dvec3() + export.origin_m) / export.metres_per_unit
}

#[test]
fn cyhair_holds_the_hairs() {
    let strands = some_hair();
    let export = export(&strands);
    let read = cyhair::read(&encode(&export, Format::CyHair).unwrap());
    assert_eq!(read.flags, 31);
    assert_eq!(read.segments, vec![(strands.points_per_strand - 1) as u16; strands.len()]);
    for i in 0..strands.points_m.len() {
        let (hair, s) = (i / strands.points_per_strand, (i % strands.points_per_strand) as f32);
        let s = s / (strands.points_per_strand - 1) as f32;
        let at = Vec3::from(read.points[i]).as_dvec3();
        assert!((at - in_units(&export, i)).abs().max_element() < 0.01, "{at}");
        let diameter = 200.0 * strands.root_radius_m[hair] * strands.profile.radius_factor(s);
        assert!((read.thickness[i] - diameter).abs() < 1e-6);
        assert!((1.0 - read.transparency[i] - strands.profile.opacity_at(s)).abs() < 1e-6);
        assert_eq!(read.colours[i], (strands.tint[hair] * strands.profile.ramp_at(s)).to_array());
    }
}

#[test]
fn usd_curves_hold_the_hairs() {
    let strands = some_hair();
    let export = export(&strands);
    let text = String::from_utf8(encode(&export, Format::Usda).unwrap()).unwrap();
    let layer = usda::read(&text);
    let value = |path: &str| &layer.values[path];
    assert_eq!(value("(defaultPrim)"), &usda::Value::Text("_2_bent_skins".into()));
    assert_eq!(value("(upAxis)"), &usda::Value::Text("Y".into()));
    assert_eq!(value("(metersPerUnit)"), &usda::Value::Number(0.01));
    assert_eq!(layer.types["_2_bent_skins"], "Xform");
    assert_eq!(layer.types["_2_bent_skins/GuardHair"], "BasisCurves");
    let origin = value("_2_bent_skins.xformOp:translate").numbers();
    let of = |attribute: &str| value(&format!("_2_bent_skins/GuardHair.{attribute}"));
    for (attribute, kind, interpolation) in [
        ("points", "point3f[]", ""),
        ("widths", "float[]", "vertex"),
        ("primvars:displayColor", "color3f[]", "vertex"),
        ("primvars:displayOpacity", "float[]", "vertex"),
        ("primvars:hairId", "int[]", "uniform"),
        ("extent", "float3[]", ""),
    ] {
        assert_eq!(layer.types[&format!("_2_bent_skins/GuardHair.{attribute}")], kind);
        let found = layer.values.get(&format!("_2_bent_skins/GuardHair.{attribute}(interpolation)"));
        let expected = (!interpolation.is_empty()).then(|| usda::Value::Text(interpolation.into()));
        assert_eq!(found, expected.as_ref(), "{attribute}");
    }
    assert_eq!(of("type"), &usda::Value::Text("linear".into()));
    assert_eq!(of("wrap"), &usda::Value::Text("nonperiodic".into()));
    assert_eq!(of("curveVertexCounts").numbers(), vec![strands.points_per_strand as f64; strands.len()]);
    let ids: Vec<f64> = strands.id.iter().map(|&id| f64::from(id)).collect();
    assert_eq!(of("primvars:hairId").numbers(), ids);
    let (points, widths) = (of("points").list(), of("widths").numbers());
    let extent = of("extent").numbers();
    assert_eq!((points.len(), widths.len()), (strands.points_m.len(), strands.points_m.len()));
    for (i, (point, width)) in points.iter().zip(widths).enumerate() {
        let local = point.numbers();
        let at = DVec3::from_slice(&local) + DVec3::from_slice(&origin);
        // Far from the origin the curves stay as fine as they were grown.
        assert!((at - in_units(&export, i)).abs().max_element() < 1e-5, "{at}");
        assert!(
            (0..3)
                .all(|c| extent[c] - 1e-6 <= local[c] - 0.5 * width && local[c] + 0.5 * width <= extent[3 + c] + 1e-6)
        );
    }
    let colours = of("primvars:displayColor").numbers();
    assert!(colours.len() == 3 * points.len() && colours.iter().all(|c| (0.0..=1.0).contains(c)));
}

#[test]
fn no_hair_is_a_file_too() {
    let strands = some_hair().none_alike();
    assert!(cyhair::read(&encode(&export(&strands), Format::CyHair).unwrap()).points.is_empty());
    let text = String::from_utf8(encode(&export(&strands), Format::Usda).unwrap()).unwrap();
    assert!(usda::read(&text).values["_2_bent_skins/GuardHair.points"].list().is_empty());
}

/// The readers are no mirrors of the writers: they read what others wrote.
#[test]
fn the_readers_read_other_peoples_files() {
    let Some(shared) = shared() else { return };
    let groom = shared.join("groom");
    let hair = cyhair::read(&std::fs::read(groom.join("ratboy_mohawk.hair")).unwrap());
    assert_eq!((hair.segments.len(), hair.points.len()), (2_228, 71_296));
    for (file, prim, curves) in [
        ("ratboy_mohawk_every4th.usda", "mohawk", 557),
        ("pixar_basiscurves2.usda", "", 451),
        ("pixar_more_curves.usda", "", 19),
    ] {
        let layer = usda::read(&std::fs::read_to_string(groom.join(file)).unwrap());
        let counts = |(path, value): (&String, &usda::Value)| {
            (path.starts_with(prim) && path.ends_with(".curveVertexCounts")).then(|| value.list().len())
        };
        assert_eq!(layer.values.iter().filter_map(counts).sum::<usize>(), curves, "{file}");
    }
}

#[test]
fn a_picture_can_leave_its_hairs_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let render = |strands: &str, preset: &[&str]| {
        let mut command = Command::new(furrier_path());
        command.args(["render", "sample:plane", "--size", "8x8", "--set", "guard.density_per_cm2=1"]).args(preset);
        command.arg("-o").arg(path("out.png")).arg("--export-strands").arg(path(strands));
        command.assert()
    };
    render("out.hair", &[]).success();
    render("out.usda", &["--only", "undercoat"]).success();
    let hair = cyhair::read(&std::fs::read(path("out.hair")).unwrap());
    let layer = usda::read(&std::fs::read_to_string(path("out.usda")).unwrap());
    assert!(hair.segments.len() > 10);
    assert_eq!(layer.values["plane/GuardHair.curveVertexCounts"].list().len(), hair.segments.len());
    render("out.abc", &[]).code(2);
    render("out.png", &[]).code(2);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}
