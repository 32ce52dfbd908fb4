//! Open Job Description 2023-09 with its extension TASK_CHUNKING: <https://github.com/OpenJobDescription/openjd-specifications>.

use super::Cut;
use serde_json::{Value, json};
use std::path::Path;

/// A template: a step that bakes chunks, and a step that merges what they found. A chunk with a bad asset ends well, as its failure
/// would end the session with all that waits in it; the merge fails then. `beside` is the plan's path relative to the template's folder,
/// as a default must be; none where it lies elsewhere, so that it must be given.
pub fn openjd(plan: &Path, beside: Option<&Path>, cut: Cut) -> Value {
    let last = cut.items.saturating_sub(1);
    let name = plan.file_stem().unwrap_or_default().to_string_lossy();
    // A job's name has no braces, which begin an expression, and at most 128 characters.
    let name: String = name.chars().filter(|c| !"{}".contains(*c) && !c.is_control()).take(100).collect();
    let action =
        |arguments: &[&str]| json!({ "actions": { "onRun": { "command": "{{Param.Furrier}}", "args": arguments } } });
    let mut parameter = json!({
        "name": "Plan", "type": "PATH", "objectType": "FILE", "dataFlow": "INOUT",
        "description": "The plan that `furrier batch plan` wrote",
    });
    if let Some(beside) = beside {
        parameter["default"] = json!(beside);
    }
    json!({
        "specificationVersion": "jobtemplate-2023-09",
        "extensions": ["TASK_CHUNKING"],
        "name": format!("furrier {name}"),
        "parameterDefinitions": [
            parameter,
            { "name": "Furrier", "type": "STRING", "default": "furrier", "description": "The program on the workers" },
        ],
        "steps": [
            {
                "name": "Bake",
                "parameterSpace": {
                    "taskParameterDefinitions": [{
                        "name": "Items",
                        "type": "CHUNK[INT]",
                        "range": format!("0-{last}"),
                        "chunks": {
                            "defaultTaskCount": cut.chunk,
                            "targetRuntimeSeconds": (cut.chunk_seconds.ceil() as u64).max(1),
                            "rangeConstraint": "CONTIGUOUS",
                        },
                    }],
                },
                "script": action(&[
                    "batch", "run", "{{Param.Plan}}", "--items", "{{Task.Param.Items}}", "--progress", "openjd",
                ]),
            },
            {
                "name": "Merge",
                "dependencies": [{ "dependsOn": "Bake" }],
                "script": action(&["batch", "merge", "{{Param.Plan}}"]),
            },
        ],
    })
}
