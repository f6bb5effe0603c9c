// All tests of the page in a browser, in one process, so that they share the browser and the daemon.
import "./page_test.mjs";
import "./surfaces_test.mjs";
import "./points_test.mjs";
import "./accessibility_test.mjs";
import "./docs_test.mjs";
import "./pictures_test.mjs";
