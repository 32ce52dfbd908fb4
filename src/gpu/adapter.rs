//! Which adapters there are, and the choice among them.

use crate::error::{Error, Kind, Result};
use serde::Serialize;
use std::str::FromStr;

/// Which adapter is asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// `auto`: the best adapter, hardware before software.
    #[default]
    Auto,
    /// `gpu:NAME`: the best adapter whose name contains NAME, whatever the case.
    Named(String),
}

impl FromStr for Choice {
    type Err = Error;

    /// Reads `auto`, `gpu` (any adapter, so the same as `auto` here) or `gpu:NAME`.
    fn from_str(text: &str) -> Result<Self> {
        match text.split_once(':') {
            None if text == "auto" || text == "gpu" => Ok(Self::Auto),
            Some(("gpu", name)) if !name.trim().is_empty() => Ok(Self::Named(name.trim().to_owned())),
            _ => Err(Error::usage("unknown device")
                .with_parameter("device")
                .with_found(text)
                .with_expected("auto, gpu or gpu:NAME")
                .with_hint("`furrier devices` lists the names")),
        }
    }
}

/// How an adapter computes, best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum AdapterKind {
    /// A graphics card.
    Discrete,
    /// A graphics core beside the CPU.
    Integrated,
    /// A share of a card, lent to a virtual machine.
    Virtual,
    /// The driver does not say.
    Other,
    /// The CPU itself.
    Software,
}

/// A graphics adapter.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Adapter {
    /// Name the driver gives.
    pub name: String,
    /// How it computes.
    pub kind: AdapterKind,
    /// Interface it is reached through: vulkan, metal or dx12.
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
}

impl Adapter {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
            wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
            wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
            wgpu::DeviceType::Cpu => AdapterKind::Software,
            wgpu::DeviceType::Other => AdapterKind::Other,
        };
        let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
        Self { name: info.name, kind, backend: info.backend.to_string(), driver }
    }
}

impl std::fmt::Display for Adapter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}, {:?}, {})", self.name, self.backend, self.kind, self.driver)
    }
}

/// Every adapter of this machine, best first; empty where there is none.
pub fn adapters() -> Vec<Adapter> {
    ranked(&instance()).into_iter().map(|(adapter, _)| adapter).collect()
}

/// The adapter that `choice` means among those that can present to `surface`, where there is one.
///
/// # Errors
/// [`Kind::Device`] where there is no adapter at all, naming the package that brings one, none that can present, or none of
/// the name.
pub(super) fn choose(
    instance: &wgpu::Instance,
    choice: &Choice,
    surface: Option<&wgpu::Surface<'_>>,
) -> Result<(Adapter, wgpu::Adapter)> {
    let mut found = ranked(instance);
    if found.is_empty() {
        return Err(Error::new(Kind::Device, "no graphics adapter was found").with_hint(missing_adapter_hint()));
    }
    let names = |found: &[(Adapter, wgpu::Adapter)]| {
        let names: Vec<_> = found.iter().map(|(adapter, _)| adapter.name.as_str()).collect();
        names.join("; ")
    };
    if let Some(surface) = surface {
        let all = names(&found);
        found.retain(|(_, handle)| handle.is_surface_supported(surface));
        if found.is_empty() {
            return Err(Error::new(Kind::Device, "no graphics adapter can draw into this window")
                .with_found(all)
                .with_hint(missing_adapter_hint()));
        }
    }
    let at = match choice {
        Choice::Auto => Some(0),
        Choice::Named(name) => {
            let name = name.to_lowercase();
            found.iter().position(|(adapter, _)| adapter.name.to_lowercase().contains(&name))
        }
    };
    match at {
        Some(at) => Ok(found.swap_remove(at)),
        None => Err(Error::new(Kind::Device, "no adapter has this name")
            .with_parameter("device")
            .with_found(format!("{choice:?}"))
            .with_expected(format!("a part of one of: {}", names(&found)))
            .with_hint("`furrier devices` lists the adapters")),
    }
}

/// What to install where there is no adapter.
pub fn missing_adapter_hint() -> &'static str {
    if cfg!(target_os = "linux") {
        "install a Vulkan driver; a software one will do: package `mesa-vulkan-drivers` on Debian, Ubuntu and Fedora \
         (`apt install mesa-vulkan-drivers`, `dnf install mesa-vulkan-drivers`), `vulkan-swrast` on Arch, \
         `mesa-vulkan-swrast` on Alpine"
    } else {
        "install the graphics driver that its maker gives out for this machine"
    }
}

/// The native interfaces only: the GL one would answer silently with a software adapter that lacks what we need.
pub(super) fn instance() -> wgpu::Instance {
    let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    wgpu::Instance::new(wgpu::InstanceDescriptor { backends, ..wgpu::InstanceDescriptor::new_without_display_handle() })
}

fn ranked(instance: &wgpu::Instance) -> Vec<(Adapter, wgpu::Adapter)> {
    let mut found: Vec<_> = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()))
        .into_iter()
        .map(|adapter| (Adapter::of(&adapter), adapter))
        .collect();
    found.sort_by_key(|(adapter, _)| adapter.kind);
    found
}
