//! Tar archives (ustar), as few bytes of them as files need: the same files give the same bytes.

use std::io::{self, Write};

/// The size of headers, and what files are filled up to.
const BLOCK: usize = 512;
/// How many bytes end an archive.
pub(crate) const END: usize = 2 * BLOCK;
/// The longest name of a file.
const LONGEST_NAME: usize = 100;
/// The largest file: eleven octal digits.
const LARGEST: u64 = 0o777_7777_7777;

/// An archive that is being written.
pub(crate) struct Tar<W: Write>(W);

impl<W: Write> Tar<W> {
    pub const fn new(out: W) -> Self {
        Self(out)
    }

    /// Adds a file that anybody may read, of nobody in particular, from the beginning of time.
    pub fn append(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(&header(name, bytes.len() as u64)?)?;
        self.0.write_all(bytes)?;
        self.0.write_all(&[0; BLOCK][..padding(bytes.len())])
    }

    /// Ends the archive.
    pub fn finish(mut self) -> io::Result<W> {
        self.0.write_all(&[0; END])?;
        self.0.flush()?;
        Ok(self.0)
    }
}

/// How many bytes a file of so many takes in an archive.
pub(crate) const fn size_in_archive(bytes: usize) -> usize {
    BLOCK + bytes + padding(bytes)
}

const fn padding(bytes: usize) -> usize {
    bytes.next_multiple_of(BLOCK) - bytes
}

fn header(name: &str, size: u64) -> io::Result<[u8; BLOCK]> {
    if name.len() > LONGEST_NAME || size > LARGEST {
        let reason = format!("`{name}` with {size} bytes does not fit into a tar archive");
        return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    }
    let mut header = [0; BLOCK];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, name.as_bytes());
    put(100, b"0000644\0");
    put(108, b"0000000\0");
    put(116, b"0000000\0");
    put(124, format!("{size:011o}\0").as_bytes());
    put(136, b"00000000000\0");
    // The sum is over a header whose sum is blank.
    put(148, b"        ");
    put(156, b"0");
    put(257, b"ustar\x0000");
    let sum: u32 = header.iter().map(|byte| u32::from(*byte)).sum();
    header[148..156].copy_from_slice(format!("{sum:06o}\0 ").as_bytes());
    Ok(header)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The files of an archive: names and bytes.
    fn read(mut archive: &[u8]) -> Vec<(String, Vec<u8>)> {
        let mut files = Vec::new();
        while archive[0] != 0 {
            let (header, rest) = archive.split_at(BLOCK);
            let text = |range: std::ops::Range<usize>| {
                String::from_utf8(header[range].iter().copied().take_while(|byte| *byte != 0).collect()).unwrap()
            };
            assert_eq!(text(257..263), "ustar");
            let blank: u32 = header[..148].iter().chain(&header[156..]).map(|byte| u32::from(*byte)).sum();
            assert_eq!(u32::from_str_radix(&text(148..156), 8).unwrap(), blank + 8 * u32::from(b' '));
            let size = usize::from_str_radix(&text(124..136), 8).unwrap();
            files.push((text(0..100), rest[..size].to_vec()));
            archive = &rest[size.next_multiple_of(BLOCK)..];
        }
        assert_eq!(archive, [0; END]);
        files
    }

    #[test]
    fn what_is_written_is_read() {
        let files = [("a.json", vec![b'x'; 511]), ("b.png", vec![]), ("c", vec![7; 512]), ("d", vec![1; 513])];
        let mut tar = Tar::new(Vec::new());
        let mut size = END;
        for (name, bytes) in &files {
            tar.append(name, bytes).unwrap();
            size += size_in_archive(bytes.len());
        }
        let archive = tar.finish().unwrap();
        assert_eq!(archive.len(), size);
        assert_eq!(read(&archive), files.map(|(name, bytes)| (name.to_owned(), bytes)));
    }

    #[test]
    fn names_that_do_not_fit_are_refused() {
        let error = Tar::new(Vec::new()).append(&"n".repeat(101), b"").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
    }
}
