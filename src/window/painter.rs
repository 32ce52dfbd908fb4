//! Draws the controls into the window, or into a picture of it.

use crate::asset::write;
use crate::data::image::Image8;
use crate::error::{Error, Kind, Result};
use crate::gpu::{Choice, Gpu, Screen};
use crate::stage::png;
use egui::epaint::{ClippedPrimitive, textures::TexturesDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use std::path::Path;
use std::sync::Arc;
use winit::window::Window;

/// A device that draws into a window.
pub struct Painter {
    gpu: Gpu,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    renderer: Renderer,
}

impl Painter {
    /// For `window`, by the adapter that `choice` means.
    ///
    /// # Errors
    /// As [`Gpu::open_for_surface`].
    pub fn new(window: Arc<Window>, choice: &Choice) -> Result<Self> {
        let make = |instance: &wgpu::Instance| {
            instance
                .create_surface(window)
                .map_err(|error| Error::new(Kind::Device, "the window cannot be drawn into").with_found(error))
        };
        let (gpu, Screen { surface, configuration }) = Gpu::open_for_surface(choice, make)?;
        let renderer = Renderer::new(&gpu.device, configuration.format, RendererOptions::default());
        Ok(Self { gpu, surface, configuration, renderer })
    }

    /// The longest edge of a texture.
    pub fn largest(&self) -> usize {
        self.gpu.device.limits().max_texture_dimension_2d as usize
    }

    /// Shows `jobs` in the window. A window without an area shows nothing.
    ///
    /// # Errors
    /// [`Kind::Device`] where the device fails or is lost.
    pub fn paint(
        &mut self,
        window: &Window,
        jobs: &[ClippedPrimitive],
        mut textures: TexturesDelta,
        pixels_per_point: f32,
    ) -> Result<()> {
        for (id, deltas) in textures.set.drain() {
            for delta in &deltas {
                self.renderer.update_texture(&self.gpu.device, &self.gpu.queue, id, delta);
            }
        }
        let freed: Vec<_> = textures.free.drain().collect();
        let shown = self.present(window, jobs, pixels_per_point);
        freed.iter().for_each(|id| self.renderer.free_texture(id));
        shown
    }

    fn present(&mut self, window: &Window, jobs: &[ClippedPrimitive], pixels_per_point: f32) -> Result<()> {
        let size = window.inner_size();
        if size.width == 0 || size.height == 0 {
            return Ok(());
        }
        if [size.width, size.height] != [self.configuration.width, self.configuration.height] {
            (self.configuration.width, self.configuration.height) = (size.width, size.height);
            self.surface.configure(&self.gpu.device, &self.configuration);
        }
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => frame,
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.gpu.device, &self.configuration);
                window.request_redraw();
                return Ok(());
            }
            // It is hidden, or comes to it later.
            _ => return Ok(()),
        };
        let encoder = self.draw(&frame.texture, jobs, pixels_per_point);
        window.pre_present_notify();
        self.gpu.finish(encoder)?;
        self.gpu.queue.present(frame);
        Ok(())
    }

    /// Records `jobs` into a texture of the window's size.
    fn draw(&mut self, into: &wgpu::Texture, jobs: &[ClippedPrimitive], pixels_per_point: f32) -> wgpu::CommandEncoder {
        let view = into.create_view(&Default::default());
        let screen = ScreenDescriptor { size_in_pixels: [into.width(), into.height()], pixels_per_point };
        let mut encoder = self.gpu.encoder("controls");
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        self.renderer.update_buffers(device, queue, &mut encoder, jobs, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("controls"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        self.renderer.render(&mut pass.forget_lifetime(), jobs, &screen);
        encoder
    }

    /// Writes `jobs` as a picture of the window.
    ///
    /// # Errors
    /// Where the file cannot be written, or the device fails.
    pub fn picture(&mut self, jobs: &[ClippedPrimitive], pixels_per_point: f32, path: &Path) -> Result<()> {
        let size = [self.configuration.width, self.configuration.height];
        let target = self.gpu.target("picture of the window", size, 1, self.configuration.format)?;
        let read_back = self.gpu.read_back::<[u8; 4]>(&target);
        let mut encoder = self.draw(&target, jobs, pixels_per_point);
        read_back.copy(&mut encoder, &target);
        self.gpu.finish(encoder)?;
        let blue_first = format!("{:?}", self.configuration.format).starts_with("Bgra");
        let straight = |[a, b, c, _]: [u8; 4]| if blue_first { [c, b, a, 255] } else { [a, b, c, 255] };
        let pixels = read_back.texels(&self.gpu)?.into_iter().flat_map(straight).collect();
        let image = Image8 { width: size[0], height: size[1], channels: 4, pixels };
        write::whole(path, &png::encode(&image)?, &[])
    }
}
