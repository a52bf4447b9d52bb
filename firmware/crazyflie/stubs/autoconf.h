/* The build without compensation, as app-config has it. */
