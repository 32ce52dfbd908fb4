//! `furrier.toml`: which files are baked how. Rules are applied in their order, later ones over earlier ones, all over the defaults.

use super::entries::Wanted;
use super::pattern::Pattern;
use super::scan;
use crate::asset::axes::Axis;
use crate::asset::coat::Fallback;
use crate::bake::recipe::{Choices, Layout, Recipe, Target, split_choice};
use crate::bake::units::Units;
use crate::error::{Error, Result};
use crate::preset::Preset;
use globset::{GlobBuilder, GlobSet, GlobSetBuilder};
use serde::Deserialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What a rule, or the defaults, say. What is not said is left as it was.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rule {
    /// Globs below the library: which files the rule is for. The defaults have none.
    pub files: Vec<String>,
    /// Globs of files that it is not for.
    pub except: Vec<String>,
    /// Whether these files are not baked.
    pub skip: Option<bool>,
    /// `[MATERIAL=]NAME|FILE`, a file relative to the manifest's.
    pub presets: Option<Vec<String>>,
    /// `table.key=value`; added to what earlier rules set.
    pub set: Vec<String>,
    /// Materials to fur; an empty list for all that are not by name bare.
    pub materials: Option<Vec<String>>,
    /// What a unit of the files means.
    pub units: Option<Units>,
    /// How skins are laid out.
    pub parameterisation: Option<Layout>,
    /// Which set of an asset's own coordinates.
    pub uv_set: Option<usize>,
    /// Instead of the presets' layers.
    pub layers: Option<u32>,
    /// Instead of the presets' texels.
    pub texture_size: Option<u32>,
    /// Decides all that is random.
    pub seed: Option<u64>,
    /// What viewers without the extension see: `none` or `shells:N`.
    pub fallback: Option<String>,
    /// What the coats are to be drawn by.
    pub target: Option<Target>,
    /// Which axis of the files is up.
    pub up: Option<Axis>,
    /// Which of them their fronts look along.
    pub forward: Option<Axis>,
    /// Whether coarser levels of detail are furred too.
    pub lods: Option<bool>,
    /// Where outputs go, with {path}, {dir}, {name}, {ext} of the input.
    pub output: Option<String>,
}

/// A library's own file.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Manifest {
    /// Under all rules.
    pub defaults: Rule,
    /// In their order. Without any, all assets are baked by the defaults.
    pub rules: Vec<Rule>,
    #[serde(skip)]
    path: PathBuf,
}

/// A file larger than this many bytes is another kind of file.
const LARGEST_FILE: u64 = 1 << 20;
/// Where outputs go where nothing is said.
const OUTPUT: &str = "furry/{path}.glb";

impl Manifest {
    /// Reads a manifest.
    ///
    /// # Errors
    /// Names the key that is unknown or the value that cannot be used.
    pub fn read(path: &Path) -> Result<Self> {
        let fault = |found: String| {
            Error::usage("the library's file is not valid")
                .with_file(path)
                .with_found(found)
                .with_hint("`furrier batch init` writes one with comments; docs/batch.md lists the keys")
        };
        let about =
            std::fs::metadata(path).map_err(|e| Error::input(format!("cannot read the file: {e}")).with_file(path))?;
        if about.len() > LARGEST_FILE {
            return Err(fault(format!("{} bytes", about.len())).with_expected(format!("at most {LARGEST_FILE} bytes")));
        }
        let text = std::fs::read_to_string(path).map_err(|e| fault(e.to_string()).with_expected("UTF-8 text"))?;
        let mut manifest: Self = toml::from_str(&text).map_err(|e| fault(e.to_string().trim_end().to_owned()))?;
        manifest.path = path.to_owned();
        if !manifest.defaults.files.is_empty() || !manifest.defaults.except.is_empty() {
            return Err(
                fault("files in [defaults]".into()).with_expected("globs in [[rules]]; the defaults are for all")
            );
        }
        if let Some(i) = manifest.rules.iter().position(|rule| rule.files.is_empty()) {
            return Err(
                fault(format!("rules[{i}] without files")).with_expected("files = [\"**/*.glb\"] or other globs")
            );
        }
        Ok(manifest)
    }

    /// What is to be baked below `root`; new recipes are added.
    ///
    /// # Errors
    /// Names the rule that cannot be used.
    pub(super) fn wanted(&self, root: &Path, recipes: &mut Vec<Recipe>) -> Result<Vec<Wanted>> {
        let globs = self.rules.iter().map(|rule| Ok([self.globs(&rule.files)?, self.globs(&rule.except)?]));
        let globs = globs.collect::<Result<Vec<_>>>()?;
        let patterns = std::iter::once(&self.defaults).chain(&self.rules).filter_map(|rule| rule.output.as_deref());
        let folders = patterns.chain([OUTPUT]).map(|text| Ok(Pattern::new(text)?.folder().to_owned()));
        let folders = folders.collect::<Result<Vec<PathBuf>>>().map_err(|error| error.with_file(&self.path))?;
        let aside: Vec<PathBuf> =
            folders.iter().filter(|f| !f.as_os_str().is_empty()).map(|f| root.join(f).components().collect()).collect();
        // Few sets of rules serve many files.
        let mut known: HashMap<Vec<bool>, Option<(usize, Pattern)>> = HashMap::new();
        let mut wanted = Vec::new();
        for input in scan::assets(root, &aside)? {
            let applies: Vec<bool> =
                globs.iter().map(|[files, except]| files.is_match(&input) && !except.is_match(&input)).collect();
            if !self.rules.is_empty() && !applies.contains(&true) {
                continue;
            }
            if !known.contains_key(&applies) {
                let made = self.recipe(&applies, recipes).map_err(|error| error.with_file(&self.path))?;
                known.insert(applies.clone(), made);
            }
            if let Some(Some((recipe, pattern))) = known.get(&applies) {
                wanted.push(Wanted { output: pattern.output(&input), input, recipe: *recipe });
            }
        }
        Ok(wanted)
    }

    fn globs(&self, globs: &[String]) -> Result<GlobSet> {
        let fault = |glob: &str, error: globset::Error| {
            Error::usage("a glob cannot be read")
                .with_file(&self.path)
                .with_field("files")
                .with_found(format!("{glob}: {error}"))
                .with_expected("a path with *, **, ?, [abc] or {a,b} in it")
        };
        let mut set = GlobSetBuilder::new();
        for glob in globs {
            // As in a shell: * stays within a folder, ** does not.
            set.add(GlobBuilder::new(glob).literal_separator(true).build().map_err(|error| fault(glob, error))?);
        }
        set.build().map_err(|error| fault("", error))
    }

    /// The recipe and outputs of files that these rules are for; none where they are not baked.
    fn recipe(&self, applies: &[bool], recipes: &mut Vec<Recipe>) -> Result<Option<(usize, Pattern)>> {
        let rules = self.rules.iter().zip(applies).filter(|(_, applies)| **applies).map(|(rule, _)| rule);
        let all = rules.fold(self.defaults.clone(), |under, rule| over(under, rule.clone()));
        if all.skip == Some(true) {
            return Ok(None);
        }
        let pattern = Pattern::new(all.output.as_deref().unwrap_or(OUTPUT))?;
        let recipe = self.choices(all)?.recipe()?;
        let place = recipes.iter().position(|known| *known == recipe).unwrap_or_else(|| {
            recipes.push(recipe);
            recipes.len() - 1
        });
        Ok(Some((place, pattern)))
    }

    fn choices(&self, rule: Rule) -> Result<Choices> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let default = Choices::default();
        let fallback = rule.fallback.map(|text| {
            text.parse::<Fallback>().map_err(|reason| Error::usage(reason).with_field("fallback").with_found(text))
        });
        Ok(Choices {
            presets: rule.presets.unwrap_or_default().iter().map(|choice| beside(choice, folder)).collect(),
            settings: rule.set,
            materials: rule.materials.unwrap_or(default.materials),
            units: rule.units.unwrap_or(default.units),
            layout: rule.parameterisation.unwrap_or(default.layout),
            uv_set: rule.uv_set,
            layers: rule.layers,
            texture_size: rule.texture_size,
            seed: rule.seed.unwrap_or(default.seed),
            fallback: fallback.transpose()?,
            target: rule.target.unwrap_or(default.target),
            up: rule.up,
            forward: rule.forward,
            lods: rule.lods.unwrap_or(default.lods),
        })
    }
}

/// A choice of preset with its file sought beside the manifest.
fn beside(choice: &str, folder: &Path) -> String {
    let (material, name) = split_choice(choice);
    if Preset::source(name).is_some() {
        return choice.to_owned();
    }
    let file = folder.join(name).to_string_lossy().into_owned();
    material.map_or(file.clone(), |material| format!("{material}={file}"))
}

/// What `rule` says over what was said before.
fn over(under: Rule, rule: Rule) -> Rule {
    Rule {
        files: Vec::new(),
        except: Vec::new(),
        skip: rule.skip.or(under.skip),
        presets: rule.presets.or(under.presets),
        set: [under.set, rule.set].concat(),
        materials: rule.materials.or(under.materials),
        units: rule.units.or(under.units),
        parameterisation: rule.parameterisation.or(under.parameterisation),
        uv_set: rule.uv_set.or(under.uv_set),
        layers: rule.layers.or(under.layers),
        texture_size: rule.texture_size.or(under.texture_size),
        seed: rule.seed.or(under.seed),
        fallback: rule.fallback.or(under.fallback),
        target: rule.target.or(under.target),
        up: rule.up.or(under.up),
        forward: rule.forward.or(under.forward),
        lods: rule.lods.or(under.lods),
        output: rule.output.or(under.output),
    }
}
