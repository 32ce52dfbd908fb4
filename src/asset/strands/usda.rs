//! USD text: one BasisCurves prim below an Xform that carries the origin in f64 (openusd.org, UsdGeomBasisCurves).

use super::{Export, counted, points};
use crate::error::{Error, Kind, Result};
use crate::math::{DVec3, Vec3};
use std::fmt::{self, Display, Write};

pub(super) fn encode(export: &Export<'_>) -> Result<Vec<u8>> {
    let strands = export.strands;
    counted(strands.points_m.len(), "points")?;
    counted(strands.len(), "hairs")?;
    let mut out = String::with_capacity(512 + 80 * strands.points_m.len());
    write(export, &mut out).map_err(|e| Error::new(Kind::Output, "the hairs cannot be written").with_found(e))?;
    Ok(out.into_bytes())
}

fn write(export: &Export<'_>, out: &mut String) -> fmt::Result {
    let strands = export.strands;
    let scale = export.metres_per_unit;
    let [x, y, z] = export.in_file(export.origin_m).to_array();
    let local = |p: Vec3| export.in_file(p.as_dvec3()).as_vec3();
    // USD knows files with y or z up.
    let up = if export.in_file(DVec3::Y).z > 0.0 { "Z" } else { "Y" };
    let name = identifier(export.name);
    write!(
        out,
        "#usda 1.0\n(\n    defaultPrim = \"{name}\"\n    doc = \"Guard hair grown by furrier, as polylines. Its \
         undercoat is a volume and not in this file.\"\n    metersPerUnit = {scale}\n    upAxis = \"{up}\"\n)\n\n\
         def Xform \"{name}\" (\n    kind = \"component\"\n)\n{{\n    double3 xformOp:translate = ({x}, {y}, {z})\n    \
         uniform token[] xformOpOrder = [\"xformOp:translate\"]\n\n    def BasisCurves \"GuardHair\"\n    {{\n"
    )?;
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for (&point_m, shape) in strands.points_m.iter().zip(points(export)) {
        low = low.min(local(point_m) - 0.5 * shape.diameter);
        high = high.max(local(point_m) + 0.5 * shape.diameter);
    }
    if !strands.is_empty() {
        list(out, "float3[] extent", "", [low, high].map(Triple))?;
    }
    out.push_str("        uniform token type = \"linear\"\n        uniform token wrap = \"nonperiodic\"\n");
    list(out, "int[] curveVertexCounts", "", std::iter::repeat_n(strands.points_per_strand, strands.len()))?;
    list(out, "point3f[] points", "", strands.points_m.iter().map(|&p| Triple(local(p))))?;
    list(out, "float[] widths", "vertex", points(export).map(|p| p.diameter))?;
    list(out, "color3f[] primvars:displayColor", "vertex", points(export).map(|p| Triple(p.colour)))?;
    list(out, "float[] primvars:displayOpacity", "vertex", points(export).map(|p| p.opacity))?;
    list(out, "int[] primvars:hairId", "uniform", strands.id.iter())?;
    out.push_str("    }\n}\n");
    Ok(())
}

/// Writes an array attribute of the curves.
fn list<T: Display>(
    out: &mut String,
    attribute: &str,
    interpolation: &str,
    values: impl IntoIterator<Item = T>,
) -> fmt::Result {
    write!(out, "        {attribute} = [")?;
    for (i, value) in values.into_iter().enumerate() {
        out.push_str(if i == 0 { "" } else { ", " });
        write!(out, "{value}")?;
    }
    out.push(']');
    if !interpolation.is_empty() {
        write!(out, " (\n            interpolation = \"{interpolation}\"\n        )")?;
    }
    out.push('\n');
    Ok(())
}

struct Triple(Vec3);

impl Display for Triple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {}, {})", self.0.x, self.0.y, self.0.z)
    }
}

/// A name as USD allows it.
fn identifier(name: &str) -> String {
    let mut text: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        text.insert(0, '_');
    }
    text
}
