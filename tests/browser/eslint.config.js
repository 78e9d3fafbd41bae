import js from "@eslint/js";

export default [
    { ignores: ["**/node_modules"] },
    js.configs.recommended,
    {
        languageOptions: { ecmaVersion: 2024 },
        rules: { eqeqeq: "error", "no-var": "error", "prefer-const": "error" },
    },
    {
        // One scope in the page: what one file defines, another one uses; the types are checked by tsc, which knows every name.
        files: ["**/src/report/page/script/*.js"],
        languageOptions: { sourceType: "script" },
        rules: { "no-undef": "off", "no-unused-vars": ["error", { vars: "local" }] },
    },
    {
        files: ["tests/browser/*.js"],
        rules: { "no-undef": "off" },
    },
];
