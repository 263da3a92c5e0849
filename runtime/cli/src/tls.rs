//! HTTPS: the options of what serves pages.

use std::{
    ffi::OsString,
    fs,
    net::IpAddr,
    path::{Path, PathBuf},
};

use cohabit_dialog::Identity;

use crate::{failure::bad_input, sessions};

/// What pages are served with.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct Tls {
    /// Serve pages by HTTPS: to pages from other machines browsers give a microphone only so. Without a certificate of
    /// yours one is made, which browsers ask about once
    #[arg(long)]
    tls: bool,
    /// The certificate to serve pages with by HTTPS, with those that lead to it (PEM)
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    tls_certificate: Option<PathBuf>,
    /// Its private key (PEM)
    #[arg(long, value_name = "FILE", requires = "tls_certificate")]
    tls_key: Option<PathBuf>,
}

impl Tls {
    /// What pages that are served at an address are served with by HTTPS, if they are to be.
    pub fn identity(&self, listen: IpAddr) -> anyhow::Result<Option<Identity>> {
        match (&self.tls_certificate, &self.tls_key) {
            (Some(certificate), Some(key)) => Identity::read(certificate, key).map(Some).map_err(bad_input),
            _ if self.tls => {
                let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
                let host = Some(host.trim()).filter(|host| !host.is_empty());
                let names = ["localhost", "127.0.0.1", "::1"].into_iter().chain(host).map(str::to_owned);
                let names: Vec<_> = names.chain([listen.to_string()]).collect();
                Ok(Some(Identity::own(&sessions::data_folder().join("tls"), &names)?))
            }
            _ => Ok(None),
        }
    }

    /// What people should know before they open a page.
    pub fn notice(&self, listen: IpAddr, identity: Option<&Identity>) -> Option<String> {
        match identity {
            Some(identity) if self.tls_certificate.is_none() => Some(format!(
                "Browsers will warn of the page's certificate, which was made here. It is the right one if its SHA-256 is\n{}",
                identity.fingerprint
            )),
            None if !listen.is_loopback() => Some(
                "What is said on the page can be read on the way, and browsers give it no microphone: `--tls` mends both"
                    .to_owned(),
            ),
            _ => None,
        }
    }

    /// The same as arguments of another process, which may run in another folder.
    pub fn arguments(&self) -> Vec<OsString> {
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let file = |name: &str, path: &Option<PathBuf>| {
            path.iter().flat_map(|path| [OsString::from(name), absolute(path).into()]).collect::<Vec<_>>()
        };
        let own = self.tls.then(|| "--tls".into());
        let files = [file("--tls-certificate", &self.tls_certificate), file("--tls-key", &self.tls_key)];
        own.into_iter().chain(files.concat()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_process_gets_the_same_files_wherever_it_runs() {
        let tls = Tls { tls: false, tls_certificate: Some("lab.pem".into()), tls_key: Some("/keys/lab.key".into()) };
        let here = std::env::current_dir().expect("a folder");
        let expected =
            ["--tls-certificate".into(), here.join("lab.pem").into(), "--tls-key".into(), "/keys/lab.key".into()];
        assert_eq!(tls.arguments(), expected as [OsString; 4]);
        assert_eq!(Tls { tls: true, ..Tls::default() }.arguments(), ["--tls"]);
        assert_eq!(Tls::default().arguments(), [] as [&str; 0]);
    }

    #[test]
    fn pages_for_other_machines_that_can_be_read_on_the_way_are_noted() {
        let notice = |listen: &str| Tls::default().notice(listen.parse().expect("an address"), None);
        assert_eq!(notice("127.0.0.1"), None);
        assert!(notice("0.0.0.0").is_some_and(|notice| notice.contains("--tls")));
    }
}
