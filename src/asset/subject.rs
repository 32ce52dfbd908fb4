//! What a picture of an asset is taken of: its extent, and the cameras and lights it brings along.

use super::Asset;
use super::json::At;
use crate::data::camera::Camera;
use crate::data::light::{Directional, InWorld, Point, Spot};
use crate::data::subject::{Named, Subject};
use crate::error::{Error, Result};
use crate::math::{DMat4, DVec3, Vec3};

/// The glTF extension that holds lights.
const LIGHTS: &str = "KHR_lights_punctual";

impl Asset {
    /// The asset in the rest pose, as camera and lights need to know it; a file unit is `metres_per_unit` long, and
    /// `hair_m` says how far hair reaches from a part's vertex, m.
    ///
    /// # Errors
    /// Names morph weights or nodes that cannot be read, and says where all is hidden. Cameras and lights that cannot be used fail when they are asked for.
    pub fn subject(&self, metres_per_unit: f64, hair_m: impl Fn(usize, usize) -> f32) -> Result<Subject> {
        let pose = self.rest_pose()?;
        let centre_units = self.parts.first().map_or(DVec3::ZERO, |part| part.centre_units);
        let mut subject = Subject { origin_m: centre_units * metres_per_unit, ..Subject::default() };
        for (index, part) in self.parts.iter().enumerate() {
            let mut used = vec![false; part.vertices()];
            part.stored.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
            for &node in part.nodes.iter().filter(|&&node| !self.scene.hidden[node]) {
                let points = part.posed(self, &pose, node, metres_per_unit).positions_m;
                for (v, &p) in points.iter().enumerate().filter(|(v, p)| used[*v] && p.is_finite()) {
                    subject.points_m.push(p);
                    subject.hair_m.push(hair_m(index, v));
                }
            }
        }
        if subject.points_m.is_empty() {
            return Err(Error::input("there is nothing to see")
                .with_file(&self.document.name)
                .with_field("nodes")
                .with_found("everything is hidden by KHR_node_visibility")
                .with_expected("a visible node with a mesh"));
        }
        let root = self.document.root();
        let nodes = root.list("nodes")?;
        for &node in &self.scene.shown {
            let (at, mut placed) = (&nodes[node], pose.world[node]);
            placed.w_axis = (placed.w_axis.truncate() * metres_per_unit).extend(1.0);
            if let Some(index) = at.get("camera") {
                let own = index.size().and_then(|index| root.entry("cameras", index));
                let value = own.clone().and_then(|own| camera(&own, &placed, subject.origin_m));
                subject.cameras.push(Named { names: names(at, &own, "camera", &index), value });
            }
            if let Some(index) = at.get("extensions").and_then(|e| e.get(LIGHTS)?.get("light")) {
                let own = index.size().and_then(|i| root.need("extensions")?.need(LIGHTS)?.entry("lights", i));
                let value = own.clone().and_then(|own| light(&own, &placed, metres_per_unit));
                subject.lights.push(Named { names: names(at, &own, "light", &index), value });
            }
        }
        Ok(subject)
    }
}

/// The names of a node and of what it holds; where neither has one, kind and number.
fn names(node: &At<'_>, own: &Result<At<'_>>, kind: &str, index: &At<'_>) -> Vec<String> {
    let name = |at: &At<'_>| at.value.get("name").and_then(|n| n.as_str()).filter(|n| !n.is_empty()).map(str::to_owned);
    let mut names: Vec<String> = name(node).into_iter().chain(own.as_ref().ok().and_then(name)).collect();
    if names.is_empty() {
        names.push(format!("{kind}_{}", index.value));
    }
    names
}

/// A camera looks along −z of its node, +y is up. It has its own vertical field of view in a picture of any shape.
fn camera(at: &At<'_>, placed: &DMat4, origin_m: DVec3) -> Result<Camera> {
    let kind = at.need("type")?;
    if kind.text()? != "perspective" {
        return Err(Error::usage(format!("a camera of this kind takes no picture here: {}", kind.text()?))
            .with_parameter("camera")
            .with_expected("a perspective camera"));
    }
    let yfov = at.need("perspective")?.need("yfov")?;
    let eye = placed.w_axis.truncate();
    let forward = (-placed.z_axis.truncate()).normalize_or_zero();
    // It looks at a point beside the asset's middle, so that what is near is told from what is far.
    let away_m = (origin_m - eye).dot(forward);
    let away_m = if away_m > 0.0 { away_m } else { 1.0 };
    Camera {
        eye: eye.into(),
        target: (eye + forward * away_m).into(),
        up: placed.y_axis.truncate().normalize_or_zero().into(),
        vfov_deg: yfov.number()?.to_degrees(),
    }
    .checked()
}

/// A light shines along −z of its node. Its intensity is taken as it stands: lux as irradiance, candela as intensity.
fn light(at: &At<'_>, placed: &DMat4, metres_per_unit: f64) -> Result<InWorld> {
    let colour = at.get("color").map_or(Ok([1.0; 3]), |at| at.numbers::<3>())?.map(|c| c as f32);
    let number = |at: &At<'_>, key: &str, default: f64| at.get(key).map_or(Ok(default), |at| at.number());
    let intensity = Vec3::from(colour) * number(at, "intensity", 1.0)? as f32;
    let direction = (-placed.z_axis.truncate()).normalize_or_zero().as_vec3();
    let point = || {
        let range_m = at.get("range").map(|range| range.number()).transpose()?;
        Point::new(Vec3::ZERO, intensity, range_m.map(|m| (m * metres_per_unit) as f32))
    };
    let place_m = placed.w_axis.truncate();
    let kind = at.need("type")?;
    match kind.text()? {
        "directional" => Ok(InWorld::directional(Directional::travelling(direction, intensity)?)),
        "point" => Ok(InWorld { place_m, light: point()?.into() }),
        "spot" => {
            let cone = at.get("spot");
            let angle = |key, default| cone.as_ref().map_or(Ok(default), |at| number(at, key, default));
            let (inner, outer) = (angle("innerConeAngle", 0.0)?, angle("outerConeAngle", std::f64::consts::FRAC_PI_4)?);
            Ok(InWorld { place_m, light: Spot::new(point()?, direction, inner as f32, outer as f32)?.into() })
        }
        _ => Err(kind.fault("directional, point or spot")),
    }
}
