//! What fur can grow on: one triangle primitive in its place in the world.

use super::document::Document;
use super::json::At;
use super::material::{Alpha, BaseColour, Material};
use super::repair::Notes;
use super::scene_graph::{SceneGraph, within_reach};
use super::stored::Primitive;
use super::variants::{Variant, variants};
use crate::data::mesh::Mesh;
use crate::error::{Error, Result};
use crate::math::{DAffine3, DMat3, DMat4, DVec3, Vec3};

/// What is smaller than this share of the largest part is a point to it.
const POINT: f64 = 1e-6;

/// A triangle primitive of the default scene. Mesh vertices are the stored vertices, in their order: those that its triangles
/// use.
#[derive(Clone, Debug)]
pub struct Part {
    /// glTF mesh.
    pub mesh: usize,
    /// Primitive of that mesh.
    pub primitive: usize,
    /// Nodes that show the mesh, or instances of them; the rest pose is the first one's.
    pub nodes: Vec<usize>,
    /// The skin of each of these nodes, where it has one.
    pub skins: Vec<Option<usize>>,
    /// Name of its material; `material_3` for nameless ones, `default` where there is none.
    pub material_name: String,
    /// What hair takes its colour from by default.
    pub base_colour: BaseColour,
    /// Whether its material shows both sides.
    pub double_sided: bool,
    /// How its material uses alpha.
    pub alpha: Alpha,
    /// Whether light does not change its material.
    pub unlit: bool,
    /// Names of its mesh and nodes, where the mesh has no other part.
    pub labels: Vec<String>,
    /// Which level of detail it is; 0 is the finest.
    pub level: u32,
    /// Material variants in which it has another colour.
    pub variants: Vec<Variant>,
    /// Vertex data in the primitive's own space.
    pub stored: Primitive,
    /// Middle of the whole scene, file units: the origin of every part's mesh.
    pub centre_units: DVec3,
    /// Rest pose: one transform for all vertices, or, under a skin, one per vertex.
    world_from_local: Vec<DAffine3>,
}

impl Part {
    /// Places a primitive in the rest pose of the first node that does not flatten it, which then comes first; `world` has one
    /// matrix per node.
    ///
    /// # Errors
    /// Names the node or joint whose matrix flattens the mesh, where all do.
    fn place(mut self, scene: &SceneGraph, world: &[DMat4]) -> Result<Self> {
        let mut flat = None;
        for number in 0..self.nodes.len() {
            match self.placement(scene, world, self.nodes[number], &self.stored) {
                Ok(maps) => {
                    self.world_from_local = maps;
                    self.nodes.swap(0, number);
                    self.skins.swap(0, number);
                    return Ok(self);
                }
                Err(error) => drop(flat.get_or_insert(error)),
            }
        }
        Err(flat.unwrap_or_else(|| Error::input("no node shows the mesh").with_field("nodes")))
    }

    /// Per vertex, or once for all: the affine map from the primitive's space to the world.
    fn placement(&self, scene: &SceneGraph, world: &[DMat4], node: usize, stored: &Primitive) -> Result<Vec<DAffine3>> {
        let (Some(skin), Some(influences)) = (self.skin_under(node), &stored.influences) else {
            scene.check_invertible(node, &world[node])?;
            return Ok(vec![DAffine3::from_mat4(world[node])]);
        };
        let joints = scene.joint_matrices(skin, world);
        let mut maps = Vec::with_capacity(influences.len());
        for (v, entry) in influences.iter().enumerate() {
            let blend = entry
                .iter()
                .filter(|&&(_, weight)| weight > 0.0)
                .fold(DMat4::ZERO, |sum, &(joint, weight)| sum + joints[usize::from(joint)] * f64::from(weight));
            let determinant = DMat3::from_mat4(blend).determinant();
            if !determinant.is_finite() || determinant == 0.0 || !within_reach(&blend) {
                return Err(Error::input("the rest pose of a skin flattens or tears a vertex, so hair has no way up")
                    .with_field(format!(
                        "skins[{skin}] (vertex {v} of meshes[{}].primitives[{}])",
                        self.mesh, self.primitive
                    ))
                    .with_found(format!("determinant {determinant:e}"))
                    .with_expected("joints with a scale other than zero, and within 1e15")
                    .with_hint("bake the rest pose with every joint's scale at 1"));
            }
            maps.push(DAffine3::from_mat4(blend));
        }
        Ok(maps)
    }

    /// The skin under which `node`, one of [`Self::nodes`], shows the mesh.
    pub fn skin_under(&self, node: usize) -> Option<usize> {
        self.nodes.iter().zip(&self.skins).find(|(of, _)| **of == node).and_then(|(_, skin)| *skin)
    }

    fn map(&self, vertex: usize) -> &DAffine3 {
        &self.world_from_local[if self.world_from_local.len() == 1 { 0 } else { vertex }]
    }

    /// Whether the rest pose mirrors the primitive (a negative scale), so that windings turn round.
    pub fn mirrored(&self) -> bool {
        let signs: f64 = self.world_from_local.iter().map(|map| map.matrix3.determinant().signum()).sum();
        signs < 0.0
    }

    /// Stored vertices.
    pub fn vertices(&self) -> usize {
        self.stored.positions.len()
    }

    /// World position of a vertex in the rest pose, file units.
    pub fn world_units(&self, vertex: usize) -> DVec3 {
        self.map(vertex).transform_point3(self.stored.positions[vertex].as_dvec3())
    }

    /// The rest pose as a mesh in metres; a file unit is `metres_per_unit` long.
    ///
    /// # Errors
    /// When a coordinate leaves what f32 can hold.
    pub fn mesh(&self, metres_per_unit: f64) -> Result<Mesh> {
        let stored = &self.stored;
        let vertices = 0..self.vertices();
        let direction = |v: usize, local: Vec3| (self.map(v).matrix3 * local.as_dvec3()).normalize_or_zero().as_vec3();
        let mut triangles = stored.triangles.clone();
        if self.mirrored() {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Mesh {
            origin_m: self.centre_units * metres_per_unit,
            positions_m: vertices
                .clone()
                .map(|v| ((self.world_units(v) - self.centre_units) * metres_per_unit).as_vec3())
                .collect(),
            rest_m: None,
            normals: vertices.map(|v| world_normal(&self.map(v).matrix3, stored.normals[v])).collect(),
            hair_normals: None,
            triangles,
            face_seeds: Vec::new(),
            position_class: stored.position_class.clone(),
            uv_sets: stored.uv_sets.clone(),
            colour: stored.colour.clone(),
            fur_length: stored.fur_length.clone(),
            fur_region: stored.fur_region.clone(),
            fur_direction: stored
                .fur_direction
                .as_ref()
                .map(|list| list.iter().enumerate().map(|(v, &d)| direction(v, d)).collect()),
        }
        .checked()
    }

    /// A world offset at `vertex`, m, as an offset in the primitive's own space and units.
    pub fn local_offset(&self, vertex: usize, offset_m: Vec3, metres_per_unit: f64) -> Vec3 {
        (self.local_from_world(vertex) * (offset_m.as_dvec3() / metres_per_unit)).as_vec3()
    }

    /// The linear map that takes world directions to the primitive's own space at `vertex`, rest pose, file units.
    pub fn local_from_world(&self, vertex: usize) -> DMat3 {
        self.map(vertex).matrix3.inverse()
    }

    /// The linear map of the rest pose at `vertex`, file units.
    pub fn world_from_local(&self, vertex: usize) -> DMat3 {
        self.map(vertex).matrix3
    }
}

/// A normal under a linear map: by the inverse transpose, which also keeps it outside under a mirror.
pub(super) fn world_normal(map: &DMat3, normal: Vec3) -> Vec3 {
    let turned = map.inverse().transpose() * normal.as_dvec3();
    turned.try_normalize().unwrap_or(normal.as_dvec3()).as_vec3()
}

/// Every part of the default scene, centred on the scene's middle, and the scene's bounding diagonal in file units: of its
/// finest levels of detail, or of all of them where they are asked for.
///
/// # Errors
/// Names what cannot be used; also when there is no triangle at all.
pub fn collect(
    document: &Document,
    scene: &SceneGraph,
    all_levels: bool,
    notes: &mut Notes,
) -> Result<(Vec<Part>, f64)> {
    let root = document.root();
    let nodes = root.list("nodes")?;
    let world = scene.world(&scene.local);
    let mut instances: Vec<Vec<usize>> = vec![Vec::new(); document.count("meshes")];
    let linked = (0..nodes.len()).filter(|&node| scene.levels.linked[node] && !scene.shown.contains(&node));
    for node in scene.shown.iter().copied().chain(linked) {
        if let Some(mesh) = nodes[node].reference("mesh", "meshes", instances.len())?
            && (all_levels || scene.levels.level[node] == 0)
        {
            instances[mesh].extend(scene.placed(node));
        }
    }
    for (finest, coarser) in &scene.levels.groups {
        let coarser = coarser.join(", ");
        if all_levels {
            notes.told.push(format!(
                "levels of detail are furred each by itself: {finest}, {coarser}; `furrier view` draws the first alone"
            ));
        } else {
            notes.warn(format!(
                "coarser levels of detail of {finest}, which alone is furred and drawn: {coarser} stay as they are, without \
                 fur; `lods` furs them too"
            ));
        }
    }
    let mut parts = Vec::new();
    let mut passed_over = 0;
    let mut vertices = 0;
    let mut flat = None;
    for (mesh, nodes_of) in instances.into_iter().enumerate().filter(|(_, nodes)| !nodes.is_empty()) {
        let at = root.entry("meshes", mesh)?;
        if super::extension::is_fallback(&at) {
            continue;
        }
        let labels = labels(&at, nodes_of.iter().map(|&node| &nodes[scene.of_document(node)]))?;
        for (primitive, at) in at.list("primitives")?.iter().enumerate() {
            match at.size_or("mode", 4)? {
                4..=6 => {}
                0..=3 => {
                    passed_over += 1;
                    continue;
                }
                _ => return Err(at.need("mode")?.fault("0 to 6")),
            }
            let skin_of = |&node: &usize| nodes[scene.of_document(node)].reference("skin", "skins", scene.skins.len());
            let skins: Vec<Option<usize>> = nodes_of.iter().map(skin_of).collect::<Result<_>>()?;
            let joints = skins.iter().flatten().map(|&skin| scene.skins[skin].joints.len()).min();
            let stored = Primitive::read(document, at, joints, notes)?;
            if stored.triangles.is_empty() {
                notes.warn(format!("{}: no triangles; passed over", at.path));
                continue;
            }
            vertices += stored.positions.len();
            if u32::try_from(vertices).is_err() {
                return Err(at.fault(&format!("at most {} vertices in all", u32::MAX)).with_hint("decimate the mesh"));
            }
            let index = at.reference("material", "materials", document.count("materials"))?;
            let material = Material::of(document, index, notes)?;
            if let Some(texture) = material.base_colour.texture.as_ref().filter(|t| t.uv_set >= stored.uv_sets.len()) {
                notes.warn(format!(
                    "{}: the texture of material {:?} lies on TEXCOORD_{}, which it lacks; the base colour factor is used alone",
                    at.path, material.name, texture.uv_set
                ));
            }
            let part = Part {
                mesh,
                primitive,
                nodes: nodes_of.clone(),
                skins,
                material_name: material.name,
                double_sided: material.double_sided,
                base_colour: material.base_colour,
                alpha: material.alpha,
                unlit: material.unlit,
                labels: labels.clone(),
                level: nodes_of.iter().map(|&node| scene.levels.level[scene.of_document(node)]).min().unwrap_or(0),
                variants: Vec::new(),
                stored,
                centre_units: DVec3::ZERO,
                world_from_local: Vec::new(),
            };
            let part = Part { variants: variants(document, at, index, &part.base_colour)?, ..part };
            match part.place(scene, &world) {
                Ok(part) => parts.push(part),
                // Programs hide things by a scale of zero.
                Err(error) => {
                    let place = error.field.as_deref().unwrap_or_default();
                    notes.warn(format!("{}: {} ({place}); left without fur", at.path, error.what));
                    flat.get_or_insert(error);
                }
            }
        }
    }
    leave_out_points(&mut parts, notes);
    if passed_over > 0 {
        notes.warn(format!("{passed_over} primitives of points or lines passed over"));
    }
    if let Some(error) = flat.filter(|_| parts.is_empty()) {
        return Err(error);
    }
    if parts.is_empty() {
        return Err(Error::input("there is nothing that fur could grow on")
            .with_field("meshes")
            .with_found("no triangle in the default scene")
            .with_expected("at least one primitive of triangles")
            .with_hint("export the mesh with faces, in the scene that is shown"));
    }
    // Coarser levels of detail change nothing in the finest.
    let finest = parts.iter().map(|part| part.level).min();
    let measured = || parts.iter().filter(|part| Some(part.level) == finest);
    let points = || measured().flat_map(|part| (0..part.vertices()).map(|v| part.world_units(v)));
    let low = points().fold(DVec3::INFINITY, DVec3::min);
    let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
    if !(low.is_finite() && high.is_finite()) {
        return Err(Error::input("the scene's size is not a finite number").with_field("nodes").with_found(high - low));
    }
    parts.iter_mut().for_each(|part| part.centre_units = 0.5 * (low + high));
    Ok((parts, (high - low).length()))
}

/// Leaves out parts that a scale has made so small that single precision has one point for them, beside others that it has not.
fn leave_out_points(parts: &mut Vec<Part>, notes: &mut Notes) {
    let points = |part: &Part| (0..part.vertices()).map(|v| part.world_units(v)).collect::<Vec<DVec3>>();
    let sizes: Vec<f64> = parts.iter().map(|part| diagonal(points(part).into_iter())).collect();
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let mut sizes = sizes.into_iter();
    parts.retain(|part| {
        let size = sizes.next().unwrap_or(largest);
        let kept = size > POINT * largest || !largest.is_finite();
        if !kept {
            let place = format!("meshes[{}].primitives[{}]", part.mesh, part.primitive);
            let nodes = part.nodes.first().copied().unwrap_or_default();
            notes.warn(format!(
                "{place}: its nodes' scale leaves it {size:.1e} units across (nodes[{nodes}]), a point beside what is {largest:.1e}; \
                 left without fur"
            ));
        }
        kept
    });
}

fn diagonal(points: impl Iterator<Item = DVec3>) -> f64 {
    let (low, high) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    (high - low).length()
}

/// The names of a mesh of one primitive, and of the nodes that show it.
fn labels<'a>(mesh: &At<'_>, nodes: impl Iterator<Item = &'a At<'a>>) -> Result<Vec<String>> {
    if mesh.list("primitives")?.len() > 1 {
        return Ok(Vec::new());
    }
    let name = |at: &At<'_>| at.get("name").and_then(|name| name.value.as_str()).map(str::to_owned);
    Ok(name(mesh).into_iter().chain(nodes.filter_map(name)).collect())
}
