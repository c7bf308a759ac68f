# SPDX-License-Identifier: GPL-2.0-only
"""Answers and refusals of the server of a view (docs/security.md), and its end."""

import http.client
import json
import re
import shutil
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import OutputError, UsageError
from mdanim_lammps.results.files import claimed
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.progress import PROGRESS, ProgressLog
from mdanim_lammps.view import beside, server
from mdanim_lammps.view.__main__ import serve
from mdanim_lammps.view.feed import LAYERS, packed
from mdanim_lammps.view.server import LONGEST_MESSAGE, PAGES, packaged_files
from mdanim_lammps.view.tail import MOST_ROWS, Known, Tail
from scene_texts import FALL
from view_lab import ask, page, served, token
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

UPGRADE = {
    "Upgrade": "websocket",
    "Connection": "Upgrade",
    "Sec_WebSocket_Version": "13",
    "Sec_WebSocket_Key": "AAAAAAAAAAAAAAAAAAAAAA==",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A finished run."""
    made = tmp_path_factory.mktemp("fall")
    (made / "fall.txt").write_text(FALL)
    return Scene.load(made / "fall.txt").run().folder


@pytest.fixture(scope="module")
def view(folder):
    with served(folder) as made:
        yield made


def receive_text(link) -> dict:
    """The next message that is JSON."""
    while isinstance(said := link.recv(10), bytes):
        pass
    return json.loads(said)


def news(link) -> dict:
    """All that a page of a finished run is told first."""
    return receive_text(link)["news"]


# --- what is answered -------------------------------------------------------------------------------------------------


def test_the_page_and_its_files(view):
    """Every packaged file, with its kind; the page asks for no other host."""
    page_file = ask(view)
    assert page_file.status == 200 and page_file.body == packaged_files()["/"][0]
    for path, kind in (("/main.js", "text/javascript"), ("/vendor.js", "text/javascript"), ("/view.css", "text/css")):
        answer = ask(view, path)
        assert (
            answer.status == 200 and answer.headers["Content-Type"].startswith(kind) and answer.body == packaged_files()[path][0]
        )
    assert not re.search(rb"(src|href)=\"(https?:)?//", page_file.body)


def test_a_page_is_told_all_and_gets_scene_and_frames(view, folder):
    """The ledger, the end, cost and expectations; scene and frames as the feed has them; an error for what is not there."""
    with page(view) as link:
        told = news(link)
        ledger = Ledger.read(folder / "ledger.csv")
        assert told["columns"] == list(ledger.columns) and told["rows"] == [[r[c] for c in ledger.columns] for r in ledger.rows]
        assert (told["state"], told["count"], told["total"]) == ("done", 16, 16)
        assert told["facts"]["cost"]["effects"]["contact"]["place"] and len(told["facts"]["summary"]["expect"]) == 4
        link.send('{"scene": 1}')
        assert link.recv(10) == view.tail.feed().scene()
        link.send('{"get": 7, "layers": 3}')
        assert link.recv(10) == view.tail.feed().frame(7, 3)
        link.send('{"track": 0}')
        assert link.recv(10) == view.tail.feed().track(0, view.tail.count)
        link.send('{"told": 1}')
        assert json.loads(link.recv(10)) == view.tail.told().head()
        link.send('{"curve": ["plate", "contact.z"]}')
        assert link.recv(10) == packed(*view.tail.told().curve(["plate", "contact.z"]))
        link.send('{"arrows": "weight"}')
        assert link.recv(10) == packed({}, {"vector": view.tail.told().vectors("weight")})
        link.send('{"springs": 1}')
        assert link.recv(10) == view.tail.feed().springs()


def test_two_pages_at_a_time(view):
    """Each is told everything."""
    with page(view) as a, page(view) as b:
        assert news(a) == news(b)


def test_long_runs_are_told_in_part(tmp_path, folder):
    """If a message cannot hold all rows, every n-th is sent."""
    text = (folder / PROGRESS).read_text().splitlines()
    row = json.loads(text[1])["row"]
    (tmp_path / "manifest.json").write_bytes((folder / "manifest.json").read_bytes())
    (tmp_path / "scene.lock.txt").write_bytes((folder / "scene.lock.txt").read_bytes())
    with ProgressLog(tmp_path, columns=json.loads(text[0])["columns"], energies=5, frames=9000, executors=1) as log:
        for frame in range(5000):
            log.frame(frame, dict(zip(log.columns, [frame, *row[1:]])), 0.0)
    tail = Tail(tmp_path)
    rows = tail.news(known := Known())["rows"]
    assert len(rows) <= MOST_ROWS and rows[1][0] == 3.0 and "rows" not in tail.news(known)


def test_a_run_begun_anew_is_told_anew(folder, tmp_path):
    """For another file of the same name all is sent again, also if it has fewer frames; the number of files goes up."""
    again = tmp_path / "again.out"
    shutil.copytree(folder, again)
    tail, known = Tail(again), Known()
    first = tail.news(known)
    lines = (again / PROGRESS).read_text().splitlines(keepends=True)
    (again / PROGRESS).unlink()
    (again / PROGRESS).write_text("".join(line for line in lines if json.loads(line).get("frame", 0) < 3))
    tail._look()
    told = tail.news(known)
    assert told["file"] == first["file"] + 1 and told["rows"] == first["rows"][:3] and told["count"] == 3 and told["keep"] == 0


def test_a_run_that_takes_the_place_of_another(folder, tmp_path):
    """The tail waits until the old run's file is replaced; the new file counts also where its number is one that became free."""
    again = tmp_path / "again.out"
    shutil.copytree(folder, again)
    data = (again / PROGRESS).read_bytes()
    tail, known = Tail(folder), Known()
    for _ in range(3):
        tail.turn_to(again)
        tail._look()
        assert tail.news(known)["state"] == "preparing"
        (again / PROGRESS).unlink()
        (again / PROGRESS).write_bytes(data)
        tail._look()
        assert tail.news(known)["state"] == "done"


def test_runs_of_older_versions(folder, tmp_path):
    """A folder without progress.jsonl is told from its ledger."""
    old = tmp_path / "old.out"
    shutil.copytree(folder, old)
    (old / PROGRESS).unlink()
    with served(old) as made, page(made) as link:
        while news(link).get("state") != "done":
            pass
    tail = Tail(old)
    assert tail.count == 16 and tail.news(Known())["rows"][15][0] == Ledger.read(old / "ledger.csv").rows[15]["time"]


# --- what is refused --------------------------------------------------------------------------------------------------


def test_only_this_machine_reaches_it(view):
    """The socket is bound to the loopback address, and there is no option for another."""
    assert view._server.socket.getsockname()[0] == "127.0.0.1"
    usage = subprocess.run([sys.executable, "-m", "mdanim_lammps", "view", "--help"], capture_output=True, text=True).stdout
    assert "--port" in usage and "--host" not in usage


def test_without_the_token_nothing_of_a_run_is_answered(view):
    """No token, a wrong one, that of another view, or one in a cookie: 403. Packaged files, which all users of this program have,
    are what can be had without."""
    origin = f"http://127.0.0.1:{view.port}"
    for query in ("", "?t=", "?t=" + "x" * 32, f"?T={token(view)}"):
        assert ask(view, "/socket" + query, secret=False, Origin=origin, **UPGRADE).status == 403
    cookie = f"mdanim-{view.port}={token(view)}; t={token(view)}"
    assert ask(view, "/socket", secret=False, cookie=cookie, Origin=origin, **UPGRADE).status == 403
    assert ask(view, "/socket", Origin=origin, **UPGRADE).status == 101
    for path in ("/", "/main.js"):
        assert ask(view, path, secret=False).body == packaged_files()[path][0]
    assert ask(view, "/nothing", secret=False).status == 404


def test_no_other_port_is_told_the_token(view):
    """A cookie would go to every port of this machine: no answer sets one, and the page keeps the token with its own origin."""
    for path in ("/", "/main.js", "/nothing"):
        answer = ask(view, path)
        assert answer.headers["Set-Cookie"] is None and token(view).encode() not in answer.body
    assert b"cookie" not in b"".join(body for path, (body, _) in view.files.items() if path != "/vendor.js")
    assert b'history.replaceState(null, "", "/")' in ask(view, "/main.js").body


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "TRACE", "CONNECT", "OPTIONS", "HEAD", "PATCH"])
def test_other_methods_are_refused(view, method):
    """Nothing is sent but by GET."""
    for path in ("/", "/socket"):
        answer = ask(view, path, method=method)
        assert answer.status == 405 and answer.headers["Allow"] == "GET"


def test_tokens_are_compared_in_constant_time(view, monkeypatch):
    """All of them go through hmac.compare_digest; none is 128 bits or less."""
    compared = []
    monkeypatch.setattr(server.hmac, "compare_digest", lambda a, b: compared.append((a, b)) or False)
    origin = f"http://127.0.0.1:{view.port}"
    assert ask(view, "/socket", Origin=origin, **UPGRADE).status == 403 and compared == [(token(view).encode(),) * 2]
    assert len(token(view)) == 32


def test_the_token_is_nowhere_else(folder, view, tmp_path):
    """Not in the folder, not in the arguments of the process that serves, not on stderr."""
    assert not [p for p in folder.rglob("*") if p.is_file() and token(view).encode() in p.read_bytes()]
    process = subprocess.Popen(
        [sys.executable, "-m", "mdanim_lammps.view", str(folder)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        secret = process.stdout.readline().split()[0].partition("?t=")[2]
        with open(f"/proc/{process.pid}/cmdline") as arguments:
            assert len(secret) == 32 and secret not in arguments.read()
    finally:
        process.terminate()
    assert secret not in process.communicate(timeout=20)[1]


def test_a_browser_is_led_to_the_page_by_a_private_file(view, monkeypatch, tmp_path, capsys):
    """The arguments of a browser, which every user of this machine can read, name a file that its owner alone can read."""
    opened = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("webbrowser.open", lambda url: opened.append(url))
    monkeypatch.setattr(beside, "OPENING", 0.3)
    beside.show_address(view.address)
    assert capsys.readouterr().out == f"view     {view.address}\n"
    assert token(view) not in opened[0]
    file = Path(urlsplit(opened[0]).path)
    assert f'url={view.address}"' in file.read_text()
    assert file.stat().st_mode & 0o777 == 0o600 and file.parent.stat().st_mode & 0o777 == 0o700
    # To a browser this is a page of another site that leads to ours.
    led = {"Sec_Fetch_Site": "cross-site", "Sec_Fetch_Mode": "navigate", "Sec_Fetch_Dest": "document"}
    assert ask(view, **led).status == 200
    assert ask(view, secret=False, **led).status == 403 and ask(view, **led | {"Sec_Fetch_Dest": "iframe"}).status == 403
    deadline = time.monotonic() + 10
    while file.parent.exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not list(tmp_path.iterdir()), "it is there for a while only"
    beside.show_address(view.address, browser=False)
    assert len(opened) == 1


@pytest.mark.parametrize("host", ["", "evil.example", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example:{}", "[::1]:{}"])
def test_other_hosts_are_refused(view, host):
    """A name that a stranger lets lead here (DNS rebinding) is not ours."""
    assert ask(view, Host=host.format(view.port)).status in (400, 403)
    assert ask(view, Host=f"localhost:{view.port}").status == 200


@pytest.mark.parametrize("origin", ["", "null", "http://evil.example", "http://127.0.0.1:1", "https://127.0.0.1:{}"])
def test_sockets_of_other_origins_are_refused(view, origin):
    """Only our own page may open one; a missing origin is none of ours."""
    assert ask(view, "/socket", Origin=origin.format(view.port), **UPGRADE).status == 403
    with pytest.raises(InvalidStatus), page(view, origin="http://evil.example"):
        pass


def test_requests_of_other_sites_are_refused(view):
    """A page elsewhere can neither show nor load ours; no answer allows it."""
    for site, status in (("cross-site", 403), ("same-site", 403), ("same-origin", 200), ("none", 200)):
        assert ask(view, Sec_Fetch_Site=site).status == status
    for path in ("/", "/main.js", "/nothing"):
        answer = ask(view, path, Origin="http://evil.example")
        assert not [name for name in answer.headers if name.lower().startswith("access-control")]
        assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"


def test_pages_run_nothing_that_is_not_ours(view):
    """The policy of every answer: no host, no inline script, no frame."""
    for path in ("/", "/main.js", "/nothing"):
        headers = ask(view, path).headers
        policy = dict(part.strip().partition(" ")[::2] for part in headers["Content-Security-Policy"].split(";"))
        assert policy["default-src"] == "'none'" and policy["script-src"] == policy["connect-src"] == "'self'"
        assert policy["frame-ancestors"] == policy["base-uri"] == policy["form-action"] == "'none'"
        assert (headers["X-Content-Type-Options"], headers["Referrer-Policy"], headers["Cache-Control"]) == (
            "nosniff", "no-referrer", "no-store",
        )  # fmt: skip
    assert b"innerHTML" not in b"".join(body for path, (body, _) in view.files.items() if path != "/vendor.js")


@pytest.mark.parametrize(
    "path",
    [
        "/../../../etc/passwd",
        "/..%2f..%2fetc/passwd",
        "//etc/passwd",
        "/server.py",
        "/LICENSES.txt",
        "/web/main.js",
        "/index.html",
        "/%00",
    ],
)
def test_paths_lead_nowhere(view, path):
    """Names are looked up among the packaged files, and never joined to a folder."""
    assert ask(view, path).status in (400, 404)


WRONG = ["", "null", "[]", "{", "[" * 4000, b"\x00\x01", "x" * (LONGEST_MESSAGE + 1), '{"do": "rm"}', '{"do": "pause/../x"}']
WRONG += [f'{{"get": {n}, "layers": 0}}' for n in ("-1", "16", "1.5", "true", '"1"', "1e999")]
WRONG += ['{"get": 1}', f'{{"get": 1, "layers": {LAYERS + 1}}}', '{"track": 99}', '{"track": -1}', '{"track": null}']
NAMED = ("plate.speed", ["nobody", "speed"], ["plate", "distance"], 1, ["plate", "x", "y"], [["plate"], "speed"])
WRONG += [json.dumps({"curve": named}) for named in NAMED] + ['{"arrows": 1}', '{"arrows": "position"}']


@pytest.mark.parametrize("text", WRONG, ids=lambda text: repr(text)[:30])
def test_messages_are_checked(view, folder, text):
    """A message that no page of ours sends ends its connection, and only that."""
    before = sorted(p.name for p in folder.iterdir())
    with page(view) as link:
        link.send(text)
        with pytest.raises(ConnectionClosed) as end:
            list(link)
    assert end.value.rcvd.code in (1008, 1009)
    assert ask(view).status == 200 and sorted(p.name for p in folder.iterdir()) == before


def test_a_server_that_is_ended_early_ends(folder):
    """SIGTERM while the scene is made ahead, at several moments: the process ends all the same."""
    for moment in (0.0, 0.05, 0.1, 0.2, 0.3):
        command = [sys.executable, "-m", "mdanim_lammps.view", str(folder)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        process.stdout.readline()
        time.sleep(moment)
        process.terminate()
        process.communicate(timeout=30)


def test_pages_are_counted(folder, monkeypatch):
    """More than so many are refused; one that closes makes room."""
    monkeypatch.setattr(server, "PAGES", 2)
    assert PAGES == 16
    with served(folder) as view, page(view) as first, page(view) as second:
        for link in (first, second):  # a page counts from its first news on
            news(link)
        with pytest.raises(InvalidStatus) as refused, page(view):
            pass
        assert refused.value.response.status_code == 503


def test_strangers_do_not_hang_it(view):
    """A connection that says nothing, and one that says nonsense, are in nothing's way."""
    with socket.create_connection(("127.0.0.1", view.port)), socket.create_connection(("127.0.0.1", view.port)) as rude:
        rude.sendall(b"\x16\x03\x01 not http\r\n\r\n" * 100)
        assert ask(view).status == 200


def test_many_strangers_do_not_end_it(folder):
    """More silent connections than the process has descriptors: the oldest give way, pages stay, and others are answered."""
    program = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_NOFILE, (128, 128));"
        "from mdanim_lammps.view.__main__ import main; sys.argv[1:] = [sys.argv[1]]; main()"
    )
    process = subprocess.Popen([sys.executable, "-c", program, str(folder)], stdout=subprocess.PIPE, text=True)
    try:
        address = urlsplit(process.stdout.readline().strip())
        with connect(
            f"ws://{address.netloc}/socket?{address.query}", origin=f"http://{address.netloc}", compression=None
        ) as link:
            news(link)
            silent = [socket.create_connection(("127.0.0.1", address.port)) for _ in range(400)]
            for _ in range(3):
                answer = http.client.HTTPConnection("127.0.0.1", address.port, timeout=20)
                answer.request("GET", "/")
                assert answer.getresponse().status == 200
            link.send('{"scene": 1}')
            assert isinstance(link.recv(20), bytes)
            for stranger in silent:
                stranger.close()
    finally:
        process.terminate()
        process.communicate(timeout=30)


def test_a_port_that_is_taken_is_told(view, folder, capsys):
    """By its number, and the free one that is taken instead."""
    with pytest.raises(UsageError, match=f"--port {view.port}"):
        serve(folder, port=view.port)


@pytest.mark.parametrize("make", [lambda path: path.symlink_to("/etc/passwd"), lambda path: __import__("os").mkfifo(path)])
def test_folders_of_strangers(folder, tmp_path, make):
    """A folder with a link or a pipe in it is not served."""
    bad = tmp_path / "bad.out"
    shutil.copytree(folder, bad)
    make(bad / "movie.mp4")
    with pytest.raises(OutputError, match=r"movie\.mp4"):
        Tail(bad)


# --- what is asked of a run -------------------------------------------------------------------------------------------


def test_a_run_that_has_ended_is_not_commanded(view, folder):
    """No file appears in the folder of a finished run."""
    before = sorted(p.name for p in folder.iterdir())
    with page(view) as link:
        for what in ("pause", "go", "stop"):
            link.send(json.dumps({"do": what}))
        link.send('{"scene": 1}')
        while not isinstance(link.recv(10), bytes):
            pass
    assert sorted(p.name for p in folder.iterdir()) == before


def test_a_command_that_fails_is_no_answer(view, monkeypatch):
    """As in a folder that is read-only: the reason is told, and the next answer is still that to the next question."""

    def refuse(folder, what):
        raise OutputError("the folder is read-only")

    monkeypatch.setattr(server, "command", refuse)
    monkeypatch.setattr(Tail, "live", True)
    with page(view) as link:
        link.send('{"do": "pause"}')
        link.send('{"get": 3, "layers": 0}')
        said = []
        while not (said and isinstance(said[-1], bytes)):
            said.append(link.recv(10))
        assert {"refused": "the folder is read-only"} in [json.loads(text) for text in said[:-1]]
        assert said[-1] == view.tail.feed().frame(3)


def test_a_killed_run_is_told_from_one_that_goes_on(tmp_path, folder):
    """By the lock that its processes hold, not by what it said last."""
    killed = tmp_path / "killed.out"
    shutil.copytree(folder, killed)
    lines = (killed / PROGRESS).read_text().splitlines(keepends=True)
    (killed / PROGRESS).write_text("".join(lines[:9]))
    (killed / "summary.json").unlink()
    with claimed(killed):
        assert Tail(killed).news(Known())["state"] == "running"
    told = Tail(killed).news(Known())
    assert told["state"] == "killed" and told["count"] == 8


# --- when it ends -----------------------------------------------------------------------------------------------------


def test_it_ends_when_nothing_needs_it(folder):
    """Soon after the last page is closed and the run is over, not while one is open."""
    with served(folder, linger=0.4) as view:
        waiting = threading.Thread(target=view.wait)
        with page(view) as link:
            news(link)
            waiting.start()
            time.sleep(1.0)
            assert waiting.is_alive() and ask(view).status == 200
        waiting.join(10)
        assert not waiting.is_alive()


def test_a_folder_without_a_run(folder, tmp_path):
    """While a run is about to begin in it the page waits; if none does, it says so, and the server ends."""
    (tmp_path / "built.out").mkdir()
    for name in ("manifest.json", "scene.lock.txt"):
        shutil.copy(folder / name, tmp_path / "built.out")
    with claimed(tmp_path / "built.out"):
        assert Tail(tmp_path / "built.out").news(Known())["state"] == "preparing"
        with served(tmp_path / "built.out", linger=0.2) as view, page(view) as link:
            assert news(link)["state"] == "preparing"
            link.send('{"scene": 1}')
            assert "no such trajectory" in receive_text(link)["error"]
    with served(tmp_path / "built.out", linger=0.2) as view:
        with page(view) as link:
            told = news(link)
            assert told["state"] == "failed" and "no such trajectory" in told["message"]
        view.wait()


def test_no_thread_stays_behind(folder):
    """Neither of the server nor of its pages."""
    before = set(threading.enumerate())
    with served(folder) as view, page(view) as link:
        news(link)
        ask(view)
        view.end()
        with pytest.raises(ConnectionClosed):
            link.recv(10)
    deadline = time.monotonic() + 10
    while set(threading.enumerate()) - before and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not set(threading.enumerate()) - before
