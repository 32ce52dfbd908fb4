//! The node hierarchy and skins, in f64: a part may lie 10⁶ units from the origin.

use super::document::Document;
use super::json::At;
use super::lod::Levels;
use crate::error::{Error, Result};
use crate::math::{DMat3, DMat4, DQuat, DVec3, Vec3};

/// Largest scale and way of a node in the world; the least scale is one over it.
const MOST_SCALE: f64 = 1e15;

/// A node's own transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Local {
    /// A matrix; cannot be animated.
    Matrix(DMat4),
    /// Scale, then rotation, then translation.
    Trs {
        /// Applied last.
        translation: DVec3,
        /// Unit quaternion.
        rotation: DQuat,
        /// Applied first.
        scale: DVec3,
    },
}

impl Local {
    fn of(node: &At<'_>) -> Result<Self> {
        if let Some(matrix) = node.get("matrix") {
            return Ok(Self::Matrix(DMat4::from_cols_array(&matrix.numbers()?)));
        }
        let triple =
            |key: &str, default: DVec3| node.get(key).map_or(Ok(default), |at| at.numbers().map(DVec3::from_array));
        let rotation = match node.get("rotation") {
            Some(at) => unit(DQuat::from_array(at.numbers()?)).ok_or_else(|| at.fault("a unit quaternion"))?,
            None => DQuat::IDENTITY,
        };
        Ok(Self::Trs {
            translation: triple("translation", DVec3::ZERO)?,
            rotation,
            scale: triple("scale", DVec3::ONE)?,
        })
    }

    /// As a matrix.
    pub fn matrix(&self) -> DMat4 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Trs { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }
}

/// A quaternion scaled to unit length, if it can be.
pub(super) fn unit(q: DQuat) -> Option<DQuat> {
    let length = q.length();
    (length.is_finite() && length > 1e-9).then(|| q / length)
}

/// Nodes in an order in which parents come first. Behind those of the document stand instances (EXT_mesh_gpu_instancing), each
/// a child of the node that has it.
#[derive(Clone, Debug, Default)]
pub struct SceneGraph {
    /// Per node.
    pub local: Vec<Local>,
    /// Per node.
    pub parent: Vec<Option<usize>>,
    /// Every node, parents before children.
    pub order: Vec<usize>,
    /// Nodes of the default scene.
    pub shown: Vec<usize>,
    /// Per skin: joints and their inverse bind matrices.
    pub skins: Vec<Skin>,
    /// Turns the file's axes to those of the world, y up and z forward; none where they are the same.
    pub upright: Option<DMat3>,
    /// Nodes of the document.
    pub document_nodes: usize,
    /// Levels of detail.
    pub levels: Levels,
    /// Per node: whether KHR_node_visibility hides it, by itself or by a node above.
    pub hidden: Vec<bool>,
}

/// Joints of a skin.
#[derive(Clone, Debug)]
pub struct Skin {
    /// Node and inverse bind matrix of each joint.
    pub joints: Vec<(usize, DMat4)>,
}

impl SceneGraph {
    /// Reads the hierarchy of a validated document.
    ///
    /// # Errors
    /// Names a transform that is not finite numbers.
    pub fn of(document: &Document) -> Result<Self> {
        let root = document.root();
        let nodes = root.list("nodes")?;
        let mut scene = Self { parent: vec![None; nodes.len()], ..Self::default() };
        let mut children = Vec::with_capacity(nodes.len());
        for (i, node) in nodes.iter().enumerate() {
            scene.local.push(Local::of(node)?);
            let list: Vec<usize> = node.list("children")?.iter().map(At::size).collect::<Result<_>>()?;
            for &child in &list {
                *scene.parent.get_mut(child).ok_or_else(|| node.fault("children that exist"))? = Some(i);
            }
            children.push(list);
        }
        let spread = |roots: Vec<usize>| {
            let mut reached = roots;
            let mut next = 0;
            while let Some(&i) = reached.get(next) {
                reached.extend(&children[i]);
                next += 1;
            }
            reached
        };
        let roots: Vec<usize> = (0..nodes.len()).filter(|&i| scene.parent[i].is_none()).collect();
        scene.order = spread(roots.clone());
        let scenes = root.list("scenes")?;
        scene.shown = match scenes.get(root.size_or("scene", 0)?) {
            Some(shown) => spread(shown.list("nodes")?.iter().map(At::size).collect::<Result<_>>()?),
            None => scene.order.clone(),
        };
        scene.levels = Levels::of(&nodes, document, &scene.parent, (&scene.order, &scene.shown))?;
        let invisible = |at: &At<'_>| {
            let visible = at.get("extensions").and_then(|e| e.get("KHR_node_visibility")?.get("visible"));
            visible.is_some_and(|visible| visible.value.as_bool() == Some(false))
        };
        scene.hidden = nodes.iter().map(invisible).collect();
        for &node in &scene.order {
            scene.hidden[node] |= scene.parent[node].is_some_and(|above| scene.hidden[above]);
        }
        scene.add_instances(document, &nodes)?;
        scene.shown.sort_unstable();
        scene.shown.dedup();
        for skin in root.list("skins")? {
            scene.skins.push(read_skin(document, &skin)?);
        }
        Ok(scene)
    }

    /// World coordinates of a place in the file's.
    pub fn world_from_file(&self, place: DVec3) -> DVec3 {
        self.upright.map_or(place, |turn| turn * place)
    }

    /// Adds what EXT_mesh_gpu_instancing places.
    fn add_instances(&mut self, document: &Document, nodes: &[At<'_>]) -> Result<()> {
        self.document_nodes = nodes.len();
        for (node, at) in nodes.iter().enumerate() {
            let Some(instancing) = at.get("extensions").and_then(|e| e.get("EXT_mesh_gpu_instancing")) else {
                continue;
            };
            let attributes = instancing.need("attributes")?;
            let read = |key: &str, width: usize| -> Result<Vec<f32>> {
                let Some(at) = attributes.get(key) else { return Ok(Vec::new()) };
                at.index_into("accessors", document.count("accessors"))?;
                document.floats(at.size()?, width)
            };
            let (places, turns, scales) = (read("TRANSLATION", 3)?, read("ROTATION", 4)?, read("SCALE", 3)?);
            let count = (places.len() / 3).max(turns.len() / 4).max(scales.len() / 3);
            if [(&places, 3), (&turns, 4), (&scales, 3)]
                .iter()
                .any(|(list, n)| !list.is_empty() && list.len() != n * count)
            {
                return Err(attributes.fault("as many translations, rotations and scales"));
            }
            let triple = |list: &[f32], i: usize, default| {
                list.get(3 * i..3 * i + 3).map_or(default, |t| Vec3::from_slice(t).as_dvec3())
            };
            for i in 0..count {
                let turn =
                    turns.get(4 * i..4 * i + 4).map(|q| DQuat::from_array([q[0], q[1], q[2], q[3]].map(f64::from)));
                self.order.push(self.local.len());
                self.local.push(Local::Trs {
                    translation: triple(&places, i, DVec3::ZERO),
                    rotation: turn.and_then(unit).unwrap_or(DQuat::IDENTITY),
                    scale: triple(&scales, i, DVec3::ONE),
                });
                self.parent.push(Some(node));
                self.hidden.push(self.hidden[node]);
            }
        }
        Ok(())
    }

    /// What shows the mesh of a node: itself, or its instances.
    pub fn placed(&self, node: usize) -> Vec<usize> {
        let own = |&i: &usize| self.parent[i] == Some(node);
        let instances: Vec<usize> = (self.document_nodes..self.local.len()).filter(own).collect();
        if instances.is_empty() { vec![node] } else { instances }
    }

    /// The document's node that stands behind one of these.
    pub fn of_document(&self, node: usize) -> usize {
        if node < self.document_nodes { node } else { self.parent[node].unwrap_or_default() }
    }

    /// World matrix of every node, given every node's own.
    pub fn world(&self, local: &[Local]) -> Vec<DMat4> {
        let mut world = vec![DMat4::IDENTITY; local.len()];
        let upright = self.upright.map(DMat4::from_mat3);
        for &i in &self.order {
            let own = local[i].matrix();
            let standing = || upright.map_or(own, |turn| turn * own);
            world[i] = self.parent[i].map_or_else(standing, |p| world[p] * own);
        }
        world
    }

    /// Matrices that take vertices of a mesh under skin `skin` to the world, per joint.
    pub fn joint_matrices(&self, skin: usize, world: &[DMat4]) -> Vec<DMat4> {
        self.skins[skin].joints.iter().map(|&(node, inverse_bind)| world[node] * inverse_bind).collect()
    }

    /// The world matrix of `node`, which must be invertible.
    ///
    /// # Errors
    /// Names the node whose matrix flattens what hangs on it.
    pub fn check_invertible(&self, node: usize, world: &DMat4) -> Result<()> {
        let linear = DMat3::from_mat4(*world);
        let size = linear.x_axis.length().max(linear.y_axis.length()).max(linear.z_axis.length());
        let determinant = linear.determinant();
        if determinant.is_finite() && determinant.abs() > 1e-12 * size.powi(3) && size > 0.0 {
            if within_reach(world) {
                return Ok(());
            }
            let far = world.w_axis.truncate().abs().max_element();
            return Err(Error::input("a node's world matrix is beyond what places can be told in")
                .with_field(format!("nodes[{node}]"))
                .with_found(format!("a scale of {size:e}, a way of {far:e}"))
                .with_expected(format!(
                    "scales from {:e} to {MOST_SCALE:e}, ways up to {MOST_SCALE:e}",
                    1.0 / MOST_SCALE
                ))
                .with_hint("apply the scale in the modelling program before exporting"));
        }
        Err(Error::input("a node's world matrix is singular, so its mesh is flat and hair has no way up")
            .with_field(format!("nodes[{node}]"))
            .with_found(format!("determinant {determinant:e}"))
            .with_expected("a scale other than zero along every axis")
            .with_hint("apply the scale in the modelling program before exporting"))
    }
}

/// Whether a map and its inverse stay within what places can be told in.
pub fn within_reach(map: &DMat4) -> bool {
    let linear = DMat3::from_mat4(*map);
    let most = |m: &DMat3| m.to_cols_array().into_iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let inverse = linear.inverse();
    inverse.is_finite()
        && most(&inverse) <= MOST_SCALE
        && most(&linear) <= MOST_SCALE
        && map.w_axis.truncate().abs().max_element() <= MOST_SCALE
}

fn read_skin(document: &Document, skin: &At<'_>) -> Result<Skin> {
    let nodes: Vec<usize> = skin.list("joints")?.iter().map(At::size).collect::<Result<_>>()?;
    let matrices = match skin.get("inverseBindMatrices") {
        Some(at) => document.floats(at.size()?, 16)?,
        None => DMat4::IDENTITY.to_cols_array().map(|m| m as f32).repeat(nodes.len()),
    };
    let joints = nodes.into_iter().zip(matrices.chunks_exact(16)).map(|(node, m)| {
        let mut columns = [0.0; 16];
        columns.iter_mut().zip(m).for_each(|(c, &m)| *c = f64::from(m));
        (node, DMat4::from_cols_array(&columns))
    });
    Ok(Skin { joints: joints.collect() })
}
