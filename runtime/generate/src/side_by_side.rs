//! The same work on many numbers, side by side.

use std::{
    ops::Range,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
};

/// What `work` makes of each number, in their order. Each worker, of which there must be one, has a thread and takes one number after the other.
///
/// # Errors
/// Of the least number of which `work` makes one; after an error no further number is begun.
pub fn side_by_side<W: Send, R: Send, E: Send>(
    workers: &mut [W],
    numbers: Range<usize>,
    work: impl Fn(&mut W, usize) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let (next, has_failed) = (AtomicUsize::new(numbers.start), AtomicBool::new(false));
    let results = Mutex::new(Vec::new());
    let work_on = |worker: &mut W| {
        while !has_failed.load(Ordering::Relaxed) {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= numbers.end {
                break;
            }
            let result = work(worker, number);
            has_failed.fetch_or(result.is_err(), Ordering::Relaxed);
            results.lock().unwrap_or_else(PoisonError::into_inner).push((number, result));
        }
    };
    let work_on = &work_on;
    thread::scope(|scope| {
        for worker in workers {
            scope.spawn(move || work_on(worker));
        }
    });
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_and_an_error_ends_it() {
        let mut counts = [0; 3];
        let count_square = |count: &mut usize, number: usize| {
            *count += 1;
            Ok::<_, String>(number * number)
        };
        assert_eq!(side_by_side(&mut counts, 4..7, count_square), Ok(vec![16, 25, 36]));
        assert_eq!(counts.iter().sum::<usize>(), 3);
        let refuse = |(): &mut (), number: usize| if number == 2 { Err(number) } else { Ok(number) };
        assert_eq!(side_by_side(&mut [()], 0..1_000_000_000, refuse), Err(2));
        assert_eq!(side_by_side(&mut [()], 5..5, refuse), Ok(Vec::new()));
    }
}
