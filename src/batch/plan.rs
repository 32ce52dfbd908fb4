//! A numbered list of what is to be baked: made once, and worked off by as many machines as there are.

use super::estimate::Cost;
use super::record::Records;
use crate::asset::write;
use crate::bake::recipe::Recipe;
use crate::error::{Error, Result};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// One asset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Its place in the plan.
    pub item: usize,
    /// Relative to the plan's root, or absolute.
    pub input: PathBuf,
    /// Relative to the plan's root, or absolute.
    pub output: PathBuf,
    /// Which of the plan's recipes.
    pub recipe: usize,
    /// What it will cost; none until it is asked for.
    pub cost: Option<Cost>,
}

/// Assets and how they are baked.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The library's folder.
    pub root: PathBuf,
    /// Where records are kept: relative to the root, or absolute.
    pub state: PathBuf,
    /// How assets are baked.
    pub recipes: Vec<Recipe>,
    /// What is baked.
    pub entries: Vec<Entry>,
}

/// The first line of a plan's file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    furrier_plan: u32,
    root: PathBuf,
    state: PathBuf,
    items: usize,
    recipes: Vec<Recipe>,
}

/// Version of the file's layout.
const LAYOUT: u32 = 1;

impl Plan {
    /// Where an entry's input lies.
    pub fn input(&self, entry: &Entry) -> PathBuf {
        self.root.join(&entry.input)
    }

    /// Where an entry's output goes.
    pub fn output(&self, entry: &Entry) -> PathBuf {
        self.root.join(&entry.output)
    }

    /// Where records are kept.
    pub fn state(&self) -> PathBuf {
        self.root.join(&self.state)
    }

    /// The records of the outputs.
    pub fn records(&self) -> Records {
        Records::new(&self.state())
    }

    /// What an entry will cost.
    pub fn cost(&self, entry: &Entry) -> Cost {
        entry.cost.unwrap_or_else(|| Cost::of(&self.input(entry), &self.recipes[entry.recipe]))
    }

    /// With the costs of all entries.
    pub fn with_costs(mut self) -> Self {
        let costs: Vec<Cost> = self.entries.par_iter().map(|entry| self.cost(entry)).collect();
        self.entries.iter_mut().zip(costs).for_each(|(entry, cost)| entry.cost = Some(cost));
        self
    }

    /// Writes the plan as lines of JSON: what it is, then one line per asset.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let unwritable = |error: serde_json::Error| Error::input("the plan cannot be encoded").with_found(error);
        let header = Header {
            furrier_plan: LAYOUT,
            root: self.root.clone(),
            state: self.state.clone(),
            items: self.entries.len(),
            recipes: self.recipes.clone(),
        };
        let mut text = serde_json::to_vec(&header).map_err(unwritable)?;
        for entry in &self.entries {
            text.push(b'\n');
            serde_json::to_writer(&mut text, entry).map_err(unwritable)?;
        }
        text.push(b'\n');
        write::whole(path, &text, &[])
    }

    /// Reads a plan.
    ///
    /// # Errors
    /// Names the line that cannot be read.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| Error::input(format!("cannot read the plan: {error}")).with_file(path))?;
        let broken = |line: usize, found: &dyn std::fmt::Display| {
            Error::input("the plan is not valid")
                .with_file(path)
                .with_field(format!("line {line}"))
                .with_found(found)
                .with_hint("make it again with `furrier batch plan`")
        };
        let mut lines = text.lines();
        let header: Header =
            serde_json::from_str(lines.next().unwrap_or_default()).map_err(|error| broken(1, &error))?;
        if header.furrier_plan != LAYOUT {
            return Err(broken(1, &header.furrier_plan).with_expected(format!("furrier_plan {LAYOUT}")));
        }
        let mut entries = Vec::new();
        for (i, line) in lines.enumerate() {
            let entry: Entry = serde_json::from_str(line).map_err(|error| broken(i + 2, &error))?;
            if entry.item != i || entry.recipe >= header.recipes.len() {
                return Err(broken(i + 2, &line).with_expected(format!("item {i}, and a recipe that is there")));
            }
            entries.push(entry);
        }
        if entries.len() != header.items {
            return Err(broken(1, &format!("{} items", entries.len())).with_expected(header.items.to_string()));
        }
        Ok(Self { root: header.root, state: header.state, recipes: header.recipes, entries })
    }
}
