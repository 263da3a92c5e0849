//! The page by HTTPS: to a page beyond this machine, browsers give a microphone only so.

use std::{
    fs,
    io::{self, Write as _},
    os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _},
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, SystemTime},
};

use rustls::{
    ServerConfig,
    crypto::ring::{self, cipher_suite::TLS13_AES_128_GCM_SHA256},
    pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject as _},
};

/// What the files of a certificate of our own making are called.
const CERTIFICATE: &str = "certificate.pem";
const KEY: &str = "key.pem";
/// It is made anew after so long, well before it ends.
const USED_FOR: Duration = Duration::from_secs(365 * DAY_S);
const VALID_FOR: Duration = Duration::from_secs(397 * DAY_S);
/// Clocks of other machines may be so far behind.
const BEFORE: Duration = Duration::from_secs(DAY_S);
const DAY_S: u64 = 24 * 3600;

/// Why the page cannot be served by HTTPS.
#[derive(Debug, thiserror::Error)]
pub enum TlsError {
    /// A file cannot be read, or written.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file does not hold what it should.
    #[error("{path} holds no {what} in PEM form: {reason}")]
    Pem {
        /// Which.
        path: PathBuf,
        /// What was looked for.
        what: &'static str,
        /// Why.
        reason: String,
    },
    /// They do not belong together, or are of no use.
    #[error("{certificate} with {key}: {reason}")]
    Pair {
        /// The certificate's file.
        certificate: PathBuf,
        /// The key's.
        key: PathBuf,
        /// Why.
        reason: rustls::Error,
    },
    /// No certificate could be made.
    #[error("make a certificate: {0}")]
    Made(#[from] rcgen::Error),
}

/// What a page shows of itself, so that nobody else can pass for it.
#[derive(Clone, Debug)]
pub struct Identity {
    config: Arc<ServerConfig>,
    /// SHA-256 of its certificate, by which people can tell one of our own making: hexadecimal pairs between colons.
    pub fingerprint: String,
}

impl Identity {
    /// That of a certificate, with those that lead to it, and its key, from files in PEM form.
    ///
    /// # Errors
    /// [`TlsError`].
    pub fn read(certificate: &Path, key: &Path) -> Result<Self, TlsError> {
        let pem = |what, path: &Path, reason: &dyn ToString| TlsError::Pem {
            path: path.to_owned(),
            what,
            reason: reason.to_string(),
        };
        let text = |path: &Path| fs::read(path).map_err(|source| TlsError::File { path: path.to_owned(), source });
        let chain: Vec<_> = CertificateDer::pem_slice_iter(&text(certificate)?)
            .collect::<Result<_, _>>()
            .map_err(|error| pem("certificate", certificate, &error))?;
        let first = chain.first().ok_or_else(|| pem("certificate", certificate, &"there is none in it"))?;
        let fingerprint = fingerprint(first);
        let own = PrivateKeyDer::from_pem_slice(&text(key)?).map_err(|error| pem("private key", key, &error))?;
        let config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
            .with_safe_default_protocol_versions()
            .and_then(|config| config.with_no_client_auth().with_single_cert(chain, own))
            .map_err(|reason| TlsError::Pair { certificate: certificate.to_owned(), key: key.to_owned(), reason })?;
        Ok(Self { config: Arc::new(config), fingerprint })
    }

    /// That of a certificate of our own making for these names and addresses, which is kept in `folder`: a browser asks
    /// once whether to trust it.
    ///
    /// # Errors
    /// [`TlsError`].
    pub fn own(folder: &Path, names: &[String]) -> Result<Self, TlsError> {
        let (certificate, key) = (folder.join(CERTIFICATE), folder.join(KEY));
        let made = fs::metadata(&certificate).and_then(|data| data.modified());
        let age = made.ok().and_then(|made| SystemTime::now().duration_since(made).ok());
        let is_fresh = age.is_some_and(|age| age < USED_FOR);
        if !(is_fresh && key.exists()) {
            make(folder, names)?;
        }
        Self::read(&certificate, &key)
    }

    /// What a server needs to agree on keys.
    pub(crate) fn config(&self) -> Arc<ServerConfig> {
        Arc::clone(&self.config)
    }
}

/// Makes a certificate; nobody but this user can read its key.
fn make(folder: &Path, names: &[String]) -> Result<(), TlsError> {
    let now = SystemTime::now();
    let mut wanted = rcgen::CertificateParams::new(names.to_vec())?;
    wanted.not_before = (now - BEFORE).into();
    wanted.not_after = (now + VALID_FOR).into();
    wanted.distinguished_name.push(rcgen::DnType::CommonName, "Cohabit");
    let key = rcgen::KeyPair::generate()?;
    let certificate = wanted.self_signed(&key)?;
    let failed = |source| TlsError::File { path: folder.to_owned(), source };
    fs::DirBuilder::new().recursive(true).mode(0o700).create(folder).map_err(failed)?;
    keep(&folder.join(KEY), &key.serialize_pem())?;
    keep(&folder.join(CERTIFICATE), &certificate.pem())
}

/// Writes a file as a whole: who reads it meanwhile finds the one before.
fn keep(path: &Path, text: &str) -> Result<(), TlsError> {
    let new = path.with_extension(format!("{}.new", std::process::id()));
    let written = fs::OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .mode(0o600)
        .open(&new)
        .and_then(|mut file| file.write_all(text.as_bytes()))
        .and_then(|()| fs::rename(&new, path));
    written.map_err(|source| TlsError::File { path: path.to_owned(), source })
}

/// By the hash of a suite: SHA-256 comes with TLS.
fn fingerprint(certificate: &[u8]) -> String {
    let digest = TLS13_AES_128_GCM_SHA256.tls13().map(|suite| suite.common.hash_provider.hash(certificate));
    let bytes: &[u8] = digest.as_ref().map(AsRef::as_ref).unwrap_or_default();
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(":")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::{
        io::{Read as _, Write as _},
        net::{self, SocketAddr},
        os::unix::fs::PermissionsExt as _,
    };

    use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

    use super::*;
    use crate::{connections, limits::ServerLimits};

    /// A folder of a test's own, which goes when this is dropped.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("cohabit-tls-{}-{name}", std::process::id()));
            let _ = fs::remove_dir_all(&folder);
            Self(folder)
        }

        fn with(&self, name: &str, text: &str) -> PathBuf {
            fs::create_dir_all(&self.0).unwrap();
            let path = self.0.join(name);
            fs::write(&path, text).unwrap();
            path
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn own(folder: &Folder) -> Identity {
        Identity::own(&folder.0, &["localhost".to_owned()]).unwrap()
    }

    /// What `localhost` answers to a client that trusts this certificate alone.
    fn answered(address: SocketAddr, certificate: &Path) -> String {
        let mut roots = RootCertStore::empty();
        roots.add(CertificateDer::from_pem_file(certificate).unwrap()).unwrap();
        let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
            .with_safe_default_protocol_versions()
            .unwrap()
            .with_root_certificates(roots)
            .with_no_client_auth();
        let client = ClientConnection::new(Arc::new(config), "localhost".try_into().unwrap()).unwrap();
        let mut stream = StreamOwned::new(client, net::TcpStream::connect(address).unwrap());
        stream.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
        let mut text = String::new();
        // A server that closes without a word more than what it had to say has said it.
        let _ = stream.read_to_string(&mut text);
        text
    }

    #[test]
    fn a_certificate_of_our_own_is_kept_and_its_key_is_nobody_elses() {
        let folder = Folder::new("own");
        let first = own(&folder);
        assert_eq!(first.fingerprint.len(), 32 * 3 - 1);
        assert_eq!(own(&folder).fingerprint, first.fingerprint);
        assert_eq!(fs::metadata(folder.0.join(KEY)).unwrap().permissions().mode() & 0o777, 0o600);
        fs::remove_file(folder.0.join(KEY)).unwrap();
        assert_ne!(own(&folder).fingerprint, first.fingerprint);
    }

    #[test]
    fn who_trusts_the_certificate_is_answered_and_who_says_nothing_keeps_nobody_waiting() {
        let folder = Folder::new("served");
        let identity = own(&folder);
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().unwrap();
        let (address, silent) = runtime.block_on(async {
            let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
            let address = listener.local_addr().unwrap();
            let router = axum::Router::new().route("/", axum::routing::get(|| async { "the page" }));
            let never = Duration::from_secs(3600);
            let limits = ServerLimits { most_connections: 4, handshake: never, head: never, ..ServerLimits::default() };
            tokio::spawn(connections::serve(listener, Some(identity), router, limits));
            let silent: Vec<_> = (0..12).map(|_| net::TcpStream::connect(address).unwrap()).collect();
            (address, silent)
        });
        let mut plain = net::TcpStream::connect(address).unwrap();
        plain.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
        let text = answered(address, &folder.0.join(CERTIFICATE));
        assert!(text.starts_with("HTTP/1.1 200") && text.ends_with("the page"), "{text}");
        drop((silent, plain));
    }

    #[test]
    fn files_that_will_not_do_are_named() {
        let folder = Folder::new("wrong");
        own(&folder);
        let (certificate, key) = (folder.0.join(CERTIFICATE), folder.0.join(KEY));
        let told = |certificate: &Path, key: &Path| Identity::read(certificate, key).unwrap_err().to_string();
        let nowhere = folder.0.join("nowhere.pem");
        assert!(told(&nowhere, &key).contains("nowhere.pem"));
        let empty = folder.with("empty.pem", "");
        assert!(told(&empty, &key).contains("empty.pem holds no certificate in PEM form"));
        assert!(told(&certificate, &empty).contains("empty.pem holds no private key in PEM form"));
        let other = Folder::new("other");
        own(&other);
        let wrong = told(&certificate, &other.0.join(KEY));
        assert!(wrong.contains("certificate.pem with ") && wrong.contains("key.pem: "), "{wrong}");
    }
}
