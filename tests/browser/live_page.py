"""The live page in a real browser, against the real processes: live_page.py BIN_FOLDER SCREENSHOT

Prints "skipped: ..." where Chromium or Selenium is not installed.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import time

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
except ImportError:
    print("skipped: python3-selenium is not installed")
    sys.exit(0)

CHROMIUM = "/usr/bin/chromium"
DRIVER = "/usr/bin/chromedriver"
BEACONS = 50


class Processes:
    """Programs of the project, ended with the test."""

    def __init__(self, folder):
        self.folder = folder
        self.running = []
        # A domain of its own; others are busy less often than this one.
        self.environment = dict(os.environ, ROS_DOMAIN_ID=str(100 + os.getpid() % 40))

    def start(self, name, *arguments):
        process = subprocess.Popen(
            [os.path.join(self.folder, "sonopose-" + name), *arguments],
            env=self.environment, stderr=subprocess.PIPE if name == "web" else subprocess.DEVNULL, text=True)
        self.running.append(process)
        return process

    def start_web(self, listen):
        """The process and the URL that it prints."""
        process = self.start("web", "--allow-changes", "--listen", listen)
        for line in process.stderr:
            found = re.search(r"the page is at (\S+)", line)
            if found:
                return process, found.group(1)
        raise AssertionError("sonopose-web ended without a URL")

    def end(self):
        for process in self.running:
            process.terminate()
        for process in self.running:
            process.wait(10)


def open_browser():
    options = Options()
    options.binary_location = CHROMIUM
    for argument in ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                     "--disable-background-networking", "--disable-component-update", "--disable-sync",
                     "--user-data-dir=" + tempfile.mkdtemp(), "--window-size=1400,900"]:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


def wait_for(browser, what, script, seconds=20):
    """The script's value as soon as it is true."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = browser.execute_script(script)
        if value:
            return value
        time.sleep(0.1)
    raise AssertionError(f"{what}: not within {seconds} s; {browser.execute_script('return sonopose.statistics')}")


def check(condition, what):
    if not condition:
        raise AssertionError(what)
    print("ok:", what)


def errors_are_small(browser):
    """Poses against the truth, as the page shows them."""
    beacons = wait_for(browser, "all beacons are shown", f"""
        const beacons = sonopose.statistics.beacons;
        return Object.keys(beacons).length === {BEACONS} &&
          Object.values(beacons).every((beacon) => beacon.truth_error_m !== null) && beacons;""", 40)
    errors = sorted(beacon["truth_error_m"] for beacon in beacons.values())
    check(errors[len(errors) // 2] < 0.05, f"half of the poses are within 5 cm of the truth ({errors[len(errors) // 2]:.3f} m)")


def drawn_per_s(browser):
    """How often the map is drawn: the mean of five seconds, when the beacons move."""
    frames = "sonopose.statistics.frames"
    counted = "return [performance.now(), sonopose.statistics.drawn]"
    wait_for(browser, "the beacons move", f"return {frames} > 150")
    begin, drawn_before = browser.execute_script(counted)
    wait_for(browser, "frames come", f"return performance.now() > {begin + 5000}")
    end, drawn = browser.execute_script(counted)
    return 1000 * (drawn - drawn_before) / (end - begin)


def settings_can_be_changed(browser):
    browser.execute_script("""
        document.querySelector('[data-panel="settings-panel"]').click();
        const input = document.querySelector('[aria-label="outage.stale_after_s"]');
        input.value = "1.5";
        input.dispatchEvent(new Event("change"));""")
    answer = wait_for(browser, "a change is answered",
                      "return document.querySelector('#requests .accepted, #requests .refused')?.textContent")
    check("accepted" in answer, "a change of a setting is accepted: " + answer)
    browser.execute_script("""
        const input = document.querySelector('[aria-label="outage.stale_after_s"]');
        input.value = "-1";
        input.dispatchEvent(new Event("change"));""")
    answer = wait_for(browser, "a wrong value is answered",
                      "return document.querySelector('#requests .refused')?.textContent")
    check("outage.stale_after_s" in answer, "a wrong value is refused with the reason: " + answer)


def run(folder, screenshot):
    processes = Processes(folder)
    browser = None
    try:
        processes.start("fusion")
        processes.start("bridge", "--source", "sim", "--beacons", str(BEACONS))
        web, url = processes.start_web("127.0.0.1:0")
        browser = open_browser()
        browser.get(url)
        wait_for(browser, "the page is connected", "return window.sonopose?.statistics?.connected")
        errors_are_small(browser)
        rate = drawn_per_s(browser)
        check(rate >= 20, f"{BEACONS} beacons are drawn {rate:.1f} times a second")
        browser.save_screenshot(screenshot)
        settings_can_be_changed(browser)

        browser.refresh()
        wait_for(browser, "a reload shows beacons again",
                 f"return Object.keys(window.sonopose?.statistics?.beacons || {{}}).length === {BEACONS}")
        print("ok: a reload recovers")
        frames = browser.execute_script("return sonopose.statistics.frames")
        web.kill()
        wait_for(browser, "a lost connection is shown", "return document.getElementById('state').className === 'lost'")
        processes.start_web(re.search(r"//([^/]+)/", url).group(1))
        wait_for(browser, "the page connects again", f"return sonopose.statistics.connected && sonopose.statistics.frames > {frames + 5}")
        print("ok: a lost connection recovers")
        logged = [entry["message"] for entry in browser.get_log("browser")
                  if "WebSocket connection" not in entry["message"]]
        check(not logged, "the browser reports no error: " + json.dumps(logged))
    finally:
        if browser:
            browser.quit()
        processes.end()


if __name__ == "__main__":
    if not (os.path.exists(CHROMIUM) and os.path.exists(DRIVER)):
        print("skipped: chromium and chromium-driver are not installed")
        sys.exit(0)
    run(sys.argv[1], sys.argv[2])
