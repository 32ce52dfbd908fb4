//! Faults in what is baked, drawn and written.

#[cfg(unix)]
#[test]
fn kills_tell_a_file_that_is_written_in_place() {
    assert!(crate::outputs::torn_by_kills(true) > 0);
}

#[test]
fn depths_of_a_passage_tell_shares_that_are_not_complementary() {
    use crate::regions::{DEPTHS_ALIKE, depths_off};
    for factor in [0.0, 0.9, 1.1] {
        let off = depths_off(&|scene| {
            for fur in scene.furs.iter_mut().filter(|fur| fur.over_last) {
                fur.tint.to_mut().iter_mut().for_each(|tint| tint.w *= factor);
            }
        });
        assert!(off > DEPTHS_ALIKE, "{factor}: {off}");
    }
}

#[test]
fn the_fringe_tells_that_fins_are_gone() {
    use crate::silhouette::{Fins, RELIEF, near};
    let [strands, _, ours] = near(Fins::Lost);
    assert!(ours.miscovers(&strands).is_some(), "{ours:?}");
    // Where shells stand in for them, coverage tells nothing.
    let [strands, shells, ours] = near(Fins::LeftOut);
    assert!(ours.miscovers(&strands).is_none() && ours.relief_over(&shells) < RELIEF, "{ours:?}");
}

#[test]
fn the_witness_sees_one_skin_weight_and_other_small_changes() {
    use furrier::asset::{self, Asset, part::Part};
    let changed = |input: &str, change: &dyn Fn(&mut Part)| {
        let mut asset: Asset = asset::load(input).unwrap();
        let bytes = asset.document.to_glb().unwrap();
        assert_eq!(crate::witness::departures(&asset, &bytes), Vec::<String>::new());
        change(&mut asset.parts[0]);
        crate::witness::departures(&asset, &bytes)
    };
    // A hundredth of one vertex's weight goes to another joint.
    let weight = changed("sample:creature", &|part| {
        let first = &mut part.stored.influences.as_mut().unwrap()[100];
        first[0].1 -= 0.01;
        first[7] = (if first[0].0 == 0 { 1 } else { 0 }, 0.01);
    });
    assert!(weight[0].ends_with("joints and weights"), "{weight:?}");
    assert!(weight.iter().any(|fault| fault.contains("animation 0")), "it moves otherwise: {weight:?}");
    let swapped = changed("sample:plane", &|part| part.stored.triangles[5].swap(0, 1));
    assert_eq!(swapped.len(), 1, "{swapped:?}");
    let moved = changed("sample:plane", &|part| part.stored.positions[5].y += 1e-4);
    assert_eq!(moved.len(), 2, "stored and placed: {moved:?}");
}

#[test]
fn the_witness_sees_one_weight_of_a_baked_file() {
    use furrier::asset::document::Document;
    let bytes = crate::witness::baked("sample:creature");
    let mut document = Document::parse(&bytes, std::path::Path::new("baked.glb"), &mut Vec::new()).unwrap();
    let meshes = document.json["meshes"].as_array().unwrap();
    let shells = meshes.iter().rfind(|mesh| mesh["extensions"].is_object()).unwrap();
    let accessor = shells["primitives"][0]["attributes"]["WEIGHTS_0"].as_u64().unwrap() as usize;
    let accessor = &document.json["accessors"][accessor];
    assert_eq!(accessor["componentType"], 5126, "the samples' weights are floats");
    let view = &document.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let start = [&view["byteOffset"], &accessor["byteOffset"]].map(|at| at.as_u64().unwrap_or(0) as usize);
    let vertex = start[0] + start[1] + 16 * 50;
    document.binary[vertex..vertex + 8].copy_from_slice(&[0.3_f32, 0.7].map(f32::to_le_bytes).concat());
    let found = crate::witness::output_departures(&document.to_glb().unwrap(), "baked.glb");
    assert!(found.iter().any(|fault| fault.contains("joints and weights")), "{found:?}");
}

#[test]
fn a_fin_that_is_lost_doubled_or_too_thin_is_named() {
    let (asset, coat) = crate::fins::baked("cylinder");
    assert_eq!(crate::fins::fault(&asset, &coat), None);
    let faults: [fn(&mut Vec<furrier::data::coat::FinEdge>); 4] = [
        |fins| fins.clear(),
        |fins| fins.truncate(fins.len() - 1),
        |fins| fins.push(fins[0]),
        |fins| fins.iter_mut().for_each(|fin| fin.thickness *= 0.99),
    ];
    for plant in faults {
        let mut faulty = coat.clone();
        plant(&mut faulty.primitives[0].fins);
        assert!(crate::fins::fault(&asset, &faulty).is_some());
    }
}

#[test]
fn what_strands_let_through_tells_a_mip_whose_gains_are_left_out() {
    let (tile, truth) = crate::gains::tile_and_truth();
    for mip in 0..tile.shells.gains.len() {
        let mut faulty = tile.clone();
        faulty.shells.gains[mip].fill([1.0; 9]);
        let off = crate::gains::off(&faulty, &truth, mip);
        assert!(off > crate::gains::BOUND, "mip {mip}: {off}");
        if mip == 1 {
            let drawn = crate::gains::off_on_device(&faulty, &truth, mip);
            assert!(drawn > crate::gains::BOUND, "as drawn, mip {mip}: {drawn}");
        }
    }
}

#[test]
fn the_reference_sees_hair_without_its_shadow_in_the_mean() {
    let difference =
        crate::oracle::changed_against_reference(&crate::scenes::studio(), |prepared| prepared.mean = None);
    // Light that comes straight and light that was scattered before make up for each other in the mean, not from place to place.
    assert_eq!(crate::oracle::fault(&difference), Some("flip"));
}
