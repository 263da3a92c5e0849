//! An adapter changes what the rewriter writes, and one that does not fit is refused.
#![allow(clippy::unwrap_used, missing_docs)]

use cohabit_rewriter::{ModelError, Rewriter};
use safetensors::{Dtype, tensor::TensorView};

static MODEL: &[u8] = include_bytes!("../rewriter.safetensors");
const MATRIX: &str = "layers.0.attended";
/// The outputs and the inputs of that matrix.
const WIDTH: usize = 576;
const SAID: &str = "stick the kettle on, would you, and fetch me a mug";

/// An adapter of one matrix, of rank 1, all numbers of which are `bytes`.
fn adapter(outputs: usize, bytes: [u8; 2]) -> Vec<u8> {
    let up = bytes.repeat(outputs);
    let down = bytes.repeat(WIDTH);
    let tensors = [
        (format!("{MATRIX}.up"), TensorView::new(Dtype::BF16, vec![outputs, 1], &up).unwrap()),
        (format!("{MATRIX}.down"), TensorView::new(Dtype::BF16, vec![1, WIDTH], &down).unwrap()),
    ];
    safetensors::serialize(tensors, None).unwrap()
}

#[test]
fn a_change_of_nothing_changes_nothing_and_another_one_does() {
    let alone = Rewriter::new(MODEL).unwrap().rewrite(SAID, &[], "");
    let nothing = Rewriter::adapted(MODEL, &adapter(WIDTH, [0, 0])).unwrap();
    assert_eq!(nothing.rewrite(SAID, &[], ""), alone);
    // 0.25 in 16 bits.
    let something = Rewriter::adapted(MODEL, &adapter(WIDTH, 0.25_f32.to_le_bytes()[2..].try_into().unwrap())).unwrap();
    assert_ne!(something.rewrite(SAID, &[], ""), alone);
}

#[test]
fn what_does_not_fit_is_refused() {
    assert!(matches!(Rewriter::adapted(MODEL, b"no tensors"), Err(ModelError::File(_))));
    let wide = adapter(WIDTH + 1, [0, 0]);
    assert_eq!(Rewriter::adapted(MODEL, &wide).err(), Some(ModelError::Shape(MATRIX.to_owned())));
}

#[test]
fn people_at_home_are_rewritten_by_the_adapted_model() {
    let around = "kitchen with double sink; kitchen island: kettle, teapot, 2 teacup";
    let at_home = cohabit_rewriter::rewrite_at_home(SAID, &[], around);
    assert!(!at_home.is_empty());
    assert_ne!(at_home, cohabit_rewriter::rewrite(SAID, &[], around));
    assert!(at_home.iter().all(|(_, probability)| (0.0..=1.0).contains(probability)), "{at_home:?}");
}
