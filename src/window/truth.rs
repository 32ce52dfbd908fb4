//! The thread that draws the hair itself, for the picture to be held against: a first look, then the final one.

use super::look::Look;
use super::mailbox::{Receiver, Sender, mailbox};
use crate::asset::Reading;
use crate::bake::picture::{Grown, Only, PictureRequest};
use crate::bake::recipe::Recipe;
use crate::data::film::{Film, Layers};
use crate::error::{Error, Kind, Result};
use crate::hybrid::Settings;
use crate::hybrid::device::Device;
use crate::math::DVec3;
use crate::stage::projection::Projection;
use crate::volume::scene::Lighting;
use std::sync::Arc;
use std::time::Instant;

/// How good a picture of the hair is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// No finer than a first look needs.
    Preview,
    /// As good as it gets.
    Final,
}

/// Which hair is to be drawn, and how.
#[derive(Clone)]
pub struct Order {
    /// What it grows on.
    pub input: String,
    /// How that is read.
    pub reading: Reading,
    /// How it grows.
    pub recipe: Box<Recipe>,
    /// Animation by name, and seconds into it.
    pub moment: Option<(String, f64)>,
    /// How it is looked at.
    pub look: Look,
}

/// A picture of the hair.
pub struct Truth {
    /// How it is looked at.
    pub look: Look,
    /// How good it is.
    pub quality: Quality,
    /// Linear light.
    pub film: Arc<Film>,
    /// Width of the band around the outline in which hair is seen singly, pixels.
    pub fringe_px: f32,
    /// Wall time, ms.
    pub ms: f64,
}

/// Starts the thread. `answer` is called on it with each picture.
///
/// # Errors
/// Where the system has no thread to give.
pub fn start(answer: impl Fn(Result<Truth>) + Send + 'static) -> Result<Sender<Order>> {
    let (sender, orders) = mailbox();
    let work = move || serve(&orders, &answer);
    std::thread::Builder::new()
        .name("truth".into())
        .spawn(work)
        .map_err(|error| Error::new(Kind::Machine, "the thread that draws hair cannot be started").with_found(error))?;
    Ok(sender)
}

fn serve(orders: &Receiver<Order>, answer: &dyn Fn(Result<Truth>)) {
    let mut grown: Option<(PictureRequest, Grown)> = None;
    while let Some(order) = orders.take() {
        let hair = grown_for(&order, &mut grown);
        for quality in [Quality::Preview, Quality::Final] {
            // Whatever came meanwhile is drawn instead.
            if orders.superseded() {
                break;
            }
            match &hair {
                Ok(()) => {
                    if let Some((_, grown)) = &grown {
                        answer(draw(grown, &order.look, quality));
                    }
                }
                Err(error) => {
                    answer(Err(error.clone()));
                    break;
                }
            }
        }
    }
}

/// Grows what the order asks for, unless it stands there already.
fn grown_for(order: &Order, grown: &mut Option<(PictureRequest, Grown)>) -> Result<()> {
    let recipe = &order.recipe;
    let request = PictureRequest {
        input: order.input.clone(),
        reading: Reading { rebake: true, ..order.reading },
        preset: recipe.preset.clone(),
        materials: recipe.materials.clone(),
        units: recipe.units,
        seed: recipe.seed,
        pose: order.moment.clone(),
        only: Only::Hybrid,
    };
    if grown.as_ref().is_none_or(|(of, _)| *of != request) {
        // Two grooms at once may not fit into memory.
        *grown = None;
        let hair = Grown::new(&request)?;
        *grown = Some((request, hair));
    }
    Ok(())
}

fn draw(grown: &Grown, look: &Look, quality: Quality) -> Result<Truth> {
    let start = Instant::now();
    let lit = look.lighting.lit(&grown.subject, &look.camera)?;
    let size = look.size.map(|edge| edge as usize);
    let settings = match quality {
        Quality::Preview => Settings::preview(size),
        Quality::Final => Settings::best(size),
    };
    let away_m = DVec3::from(look.camera.eye).distance(DVec3::from(look.camera.target)) as f32;
    let settings = Settings { layers: Layers::Light, ..settings };
    let drawn = grown.draw_on(&Device::Cpu, &Lighting::new(&lit), &look.camera, &settings)?;
    Ok(Truth {
        look: look.clone(),
        quality,
        film: Arc::new(drawn.picture.film),
        fringe_px: grown.hair_m() * Projection::new(&look.camera, DVec3::ZERO, size)?.focal_px / away_m,
        ms: start.elapsed().as_secs_f64() * 1e3,
    })
}
