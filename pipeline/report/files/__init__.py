"""A report's folder: pages, exports, and the one lasting name for the newest."""
