//! A site: routes behind the checks and headers that all pages of this program have.

use std::{io, net::TcpListener, sync::Arc, time::Duration};

use axum::{
    Router,
    body::Bytes,
    extract::{Request, State},
    http::{HeaderName, HeaderValue, StatusCode, header, uri::Authority},
    middleware::{self, Next},
    response::{IntoResponse, Response},
    routing::get,
};

use crate::{
    connections,
    hosts::{HostName, Hosts, Refusal},
    limits::ServerLimits,
    tls::Identity,
};

/// Headers of every answer. What is sent is of the type that it says; no address, which may hold the token, is told to
/// other sites; no other site may read or embed any of it.
fn fixed_headers() -> [(HeaderName, HeaderValue); 4] {
    [
        (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
        (header::REFERRER_POLICY, HeaderValue::from_static("no-referrer")),
        (HeaderName::from_static("cross-origin-opener-policy"), HeaderValue::from_static("same-origin")),
        (HeaderName::from_static("cross-origin-resource-policy"), HeaderValue::from_static("same-origin")),
    ]
}
/// What pages may load; who may show them, and where they may connect to, follows by host.
const POLICY: &str = "default-src 'self'; base-uri 'none'; form-action 'none'; object-src 'none'";

/// Which pages show others within them. Both are then of one host.
#[derive(Clone, Copy, Debug, Default)]
pub struct Framing {
    /// The port of the server whose pages may show pages of this site.
    pub framed_by: Option<u16>,
    /// Whether pages of this site may show pages of other ports.
    pub frames_ports: bool,
}

/// Routes, and who may ask for them.
pub struct Site {
    /// The routes.
    pub router: Router,
    /// The hosts that it is served as, besides those of this machine.
    pub hosts: Vec<HostName>,
    /// What it is served with by HTTPS, if it is.
    pub identity: Option<Identity>,
    /// How long anybody may keep a place, and how many places there are.
    pub limits: ServerLimits,
    /// Which pages show others within them.
    pub framing: Framing,
}

impl Site {
    /// Serves it on `listener` until `over`.
    ///
    /// # Errors
    /// Of the network.
    pub fn serve(self, listener: TcpListener, over: &dyn Fn() -> bool) -> io::Result<()> {
        let Self { router, hosts, identity, limits, framing } = self;
        let hosts = Hosts::new(listener.local_addr()?, identity.is_some(), hosts);
        let router = router.layer(middleware::from_fn_with_state(Arc::new((hosts, framing)), guard));
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
        let served = runtime.block_on(async {
            listener.set_nonblocking(true)?;
            let listener = tokio::net::TcpListener::from_std(listener)?;
            tokio::select! {
                () = connections::serve(listener, identity, router, limits) => Ok(()),
                () = until(over) => Ok(()),
            }
        });
        runtime.shutdown_timeout(Duration::from_millis(100));
        served
    }
}

/// A file that a site serves to everybody alike.
#[derive(Clone, Debug)]
pub struct SiteFile {
    /// Where it is found; begins with `/`.
    pub path: String,
    /// Its media type.
    pub kind: &'static str,
    /// What is in it.
    pub bytes: Vec<u8>,
}

/// The media types of what sites serve most.
pub mod media {
    /// A page.
    pub const HTML: &str = "text/html; charset=utf-8";
    /// A script.
    pub const SCRIPT: &str = "text/javascript; charset=utf-8";
    /// A style sheet.
    pub const STYLE: &str = "text/css; charset=utf-8";
    /// A drawing.
    pub const SVG: &str = "image/svg+xml";
}

/// Routes of files: path, media type, content.
///
/// # Panics
/// If two files have the same path, or a path does not begin with `/`.
pub fn file_routes<S, P, B>(files: impl IntoIterator<Item = (P, &'static str, B)>) -> Router<S>
where
    S: Clone + Send + Sync + 'static,
    P: AsRef<str>,
    B: Into<Bytes>,
{
    files.into_iter().fold(Router::new(), |router, (path, kind, bytes)| {
        let bytes = bytes.into();
        router.route(path.as_ref(), get(move || file(kind, bytes)))
    })
}

/// A site of these files alone; wherever else somebody asks, they get `missing` with the status 404, whatever its path.
///
/// # Panics
/// As [`file_routes`].
pub fn site_of_files(files: Vec<SiteFile>, missing: SiteFile) -> Router {
    let bytes = Bytes::from(missing.bytes);
    file_routes(files.into_iter().map(|SiteFile { path, kind, bytes }| (path, kind, bytes)))
        .fallback(async move || (StatusCode::NOT_FOUND, file(missing.kind, bytes).await))
}

/// A file of this media type, which browsers ask for again each time.
pub async fn file(kind: &'static str, bytes: impl Into<Bytes>) -> Response {
    ([(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, "no-cache")], bytes.into()).into_response()
}

/// Stands before every route, also those that do not exist: refuses who asks for another host, or comes from another
/// site, and gives each answer its headers.
async fn guard(State(site): State<Arc<(Hosts, Framing)>>, request: Request, next: Next) -> Response {
    let (hosts, framing) = &*site;
    match hosts.check(request.uri(), request.headers()) {
        Ok(host) => with_headers(next.run(request).await, Some(&host), *framing),
        Err(refusal) => with_headers(refusal.into_response(), None, *framing),
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        (StatusCode::FORBIDDEN, format!("{self}\n")).into_response()
    }
}

fn with_headers(mut response: Response, host: Option<&Authority>, framing: Framing) -> Response {
    let headers = response.headers_mut();
    headers.extend(fixed_headers());
    // Policies have no form for addresses of IPv6.
    let host = host.filter(|host| !host.as_str().starts_with('['));
    let ancestors = host.zip(framing.framed_by).map(|(host, port)| addresses(host.host(), port));
    if ancestors.is_none() {
        headers.insert(header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY"));
    }
    let ancestors = ancestors.unwrap_or_else(|| "'none'".to_owned());
    // A host's socket is named, since older browsers do not take it for a part of `'self'`.
    let sockets = host.map(|host| format!(" ws://{host} wss://{host}")).unwrap_or_default();
    let frames = host.filter(|_| framing.frames_ports);
    let frames = frames.map(|host| format!("; frame-src {}", addresses(host.host(), "*"))).unwrap_or_default();
    let policy = format!("{POLICY}; frame-ancestors {ancestors}; connect-src 'self'{sockets}{frames}");
    headers.insert(
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::try_from(policy).unwrap_or(HeaderValue::from_static("default-src 'none'")),
    );
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}

/// A host's addresses at a port, plain and encrypted.
fn addresses(host: &str, port: impl std::fmt::Display) -> String {
    format!("http://{host}:{port} https://{host}:{port}")
}

async fn until(over: &dyn Fn() -> bool) {
    while !over() {
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn policy(host: &str, framing: Framing) -> (String, bool) {
        let response = with_headers(().into_response(), Some(&host.parse().unwrap()), framing);
        let policy = response.headers()[header::CONTENT_SECURITY_POLICY].to_str().unwrap().to_owned();
        (policy, response.headers().contains_key(header::X_FRAME_OPTIONS))
    }

    #[test]
    fn pages_are_framed_by_nobody_but_the_port_that_was_named() {
        let (alone, is_denied) = policy("localhost:80", Framing::default());
        assert!(is_denied && alone.contains("frame-ancestors 'none'") && !alone.contains("frame-src"), "{alone}");
        let (framed, is_denied) = policy("localhost:80", Framing { framed_by: Some(8700), frames_ports: false });
        let ancestors = "frame-ancestors http://localhost:8700 https://localhost:8700;";
        assert!(!is_denied && framed.contains(ancestors), "{framed}");
        let (frames, is_denied) = policy("127.0.0.1:8700", Framing { framed_by: None, frames_ports: true });
        assert!(is_denied && frames.ends_with("frame-src http://127.0.0.1:* https://127.0.0.1:*"), "{frames}");
    }
}
