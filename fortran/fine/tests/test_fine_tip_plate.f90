!> A plate with an edge crack (catalogue 1.11, plane stress, nu = 0.3): intensities, energy release
!! rate and strain energy with all three kinds of elements at the tip; other units; rock that is
!! nearly incompressible.
program test_fine_tip_plate
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use fine_boundary, only: add_side_traction, fine_boundary_t, free_boundary, mark_side, &
                            nearest_node
   use fine_elasticity, only: elasticity_t
   use fine_error, only: correct_intensity, energy_error_t, estimate_error, has_dual
   use fine_faces, only: loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_mesh, only: tip_collapsed, tip_plain, tip_quarter
   use fine_model, only: fine_model_t
   use fine_recovery, only: recover_by_patches, recovery_t
   use fine_tip_intensity, only: probe_of_tip, intensity_of_tip
   use fine_tip_interaction, only: tip_probe_t
   use fine_tip_types, only: intensity_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   integer(ik), parameter :: tension = 1, shear = 2, clamped = 3
   type(checks_t) :: checks
   type(intensity_t) :: intensity, first
   real(rk) :: energy, exact
   integer(ik) :: i

   ! Tension: K_I/(s sqrt(pi a)) and energy E/(s**2 b**2).
   call compare(tension, tip_quarter, 2.825457622_rk, 0.0_rk, 2.5270144_rk, 5.0e-4_rk)
   call compare(tension, tip_collapsed, 2.825457622_rk, 0.0_rk, 2.5270144_rk, 5.0e-4_rk)
   call compare(tension, tip_plain, 2.825457622_rk, 0.0_rk, 2.5270144_rk, 1.0e-2_rk)
   call compare(shear, tip_quarter, 0.0_rk, 1.241543274_rk, 3.134572827_rk, 5.0e-4_rk)
   call compare(shear, tip_collapsed, 0.0_rk, 1.241543274_rk, 3.134572827_rk, 5.0e-4_rk)
   call compare(clamped, tip_quarter, 8.983332615_rk, 1.362667215_rk, 40.44133743_rk, 1.0e-3_rk)

   ! The same problem from micrometres to ten kilometres, from 1 Pa to 1 GPa.
   call solve(tension, tip_quarter, 1.0_rk, 1.0_rk, 0.3_rk, first, energy, exact)
   do i = 1, 3
      associate (length => [1.0e-6_rk, 1.0e4_rk, 1.0_rk], stress => [1.0e9_rk, 1.0_rk, 1.0e9_rk])
         call solve(tension, tip_quarter, length(i), stress(i), 0.3_rk, intensity, energy, exact)
      end associate
      call checks%is_close(intensity%k1/first%k1, 1.0_rk, 1.0e-8_rk, "units: K_I")
      call checks%is_close(intensity%k1_dc/first%k1_dc, 1.0_rk, 1.0e-8_rk, "units: displacements")
      call checks%is_close(intensity%g_domain/first%g_domain, 1.0_rk, 1.0e-8_rk, "units: G")
   end do

   ! Under tractions alone K does not depend on Poisson's ratio. The collapsed elements pass; the
   ! triangles, whose strain varies less around the tip, lock by some per cent.
   call solve(tension, tip_collapsed, 1.0_rk, 1.0_rk, 0.4999_rk, intensity, energy, exact)
   print "(a,2f9.4)", "Poisson's ratio 0.4999, plane strain: errors of K_I and K_I inner in %", &
      100.0_rk*(intensity%k1/2.825457622_rk - 1.0_rk), &
      100.0_rk*(intensity%k1_inner/2.825457622_rk - 1.0_rk)
   call checks%is_close(intensity%k1/2.825457622_rk, 1.0_rk, 1.0e-3_rk, "nearly incompressible")
   call checks%is_close(intensity%k1_inner/2.825457622_rk, 1.0_rk, 2.0e-3_rk, &
                        "nearly incompressible, inner domain")
   call checks%finish()

contains

   !> Intensities and energy against the catalogue.
   subroutine compare(load, tip_element, k1, k2, expected_energy, tolerance)
      integer(ik), intent(in) :: load, tip_element
      real(rk), intent(in) :: k1, k2, expected_energy
      real(rk), intent(in) :: tolerance  !< of the total intensity [-]
      character(len=*), parameter :: loads(3) = [character(len=8) :: "tension", "shear", "clamped"]
      character(len=*), parameter :: elements(3) = &
                                     [character(len=10) :: "quarter", "collapsed", "plain"]
      real(rk) :: estimated

      call solve(load, tip_element, 1.0_rk, 1.0_rk, 0.3_rk, intensity, energy, estimated)
      associate (name => trim(loads(load))//", "//trim(elements(tip_element)), &
                 scale => hypot(k1, k2))
         print "(a,t22,6(a,f9.4))", name, "errors in %: K_I", 100.0_rk*(intensity%k1 - k1)/scale, &
            ", K_II", 100.0_rk*(abs(intensity%k2) - k2)/scale, &
            ", displacements", 100.0_rk*(hypot(intensity%k1_dc, intensity%k2_dc)/scale - 1.0_rk), &
            ", G", 100.0_rk*(intensity%g_domain/scale**2 - 1.0_rk), &
            ", energy", 100.0_rk*(energy/expected_energy - 1.0_rk), &
            ", estimated", -100.0_rk*estimated**2
         call checks%is_close(intensity%k1/scale, k1/scale, tolerance, name//": K_I")
         call checks%is_close(abs(intensity%k2)/scale, k2/scale, tolerance, name//": K_II")
         call checks%is_close(intensity%g_domain/scale**2, 1.0_rk, 2.0_rk*tolerance, name//": G")
         call checks%is_close(energy/expected_energy, 1.0_rk, tolerance, name//": energy")
         print "(a,t22,2(a,3f9.4))", name, "in %: K_I lacks, as estimated, error of it", &
            100.0_rk*[k1 - intensity%k1, intensity%k1_corrected - intensity%k1, &
                      intensity%k1_error]/scale, "; K_II", &
            100.0_rk*[sign(k2, intensity%k2) - intensity%k2, &
                      intensity%k2_corrected - intensity%k2, intensity%k2_error]/scale
         call checks%is_true(hypot(intensity%k1_corrected - k1, abs(intensity%k2_corrected) - k2) &
                             <= 0.5_rk*hypot(intensity%k1 - k1, abs(intensity%k2) - k2), &
                             name//": the correction takes half of the error at least")
         call checks%is_true(abs(intensity%k1 - k1) <= intensity%k1_error .and. &
                             abs(abs(intensity%k2) - k2) <= intensity%k2_error, &
                             name//": true errors are within the estimated ones")
         ! Stresses are given, so the energy of the solution falls short by that of its error.
         call checks%is_true(estimated**2 > 0.5_rk*(1.0_rk - energy/expected_energy) .and. &
                             estimated**2 < 2.0_rk*(1.0_rk - energy/expected_energy), &
                             name//": estimated error of the energy")
      end associate
   end subroutine compare

   !> Plate 0 < x < b, |y| < b, crack y = 0, 0 < x < b/2. Intensities over s*sqrt(pi a), energy
   !! release rate over K**2/E', energy over (s b)**2/E, all of the size of one.
   subroutine solve(load, tip_element, b, stress, poisson, dimensionless, energy_over, estimated)
      integer(ik), intent(in) :: load, tip_element
      real(rk), intent(in) :: b, stress  !< [m], [Pa]
      real(rk), intent(in) :: poisson  !< below 0.4 plane stress, else plane strain
      type(intensity_t), intent(out) :: dimensionless
      real(rk), intent(out) :: energy_over, estimated
      real(rk), parameter :: young_over = 1.0e3_rk
      type(network_t) :: network
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(fine_model_t) :: model
      type(fine_boundary_t) :: boundary
      type(fine_loads_t) :: loads
      type(recovery_t) :: recovery
      type(energy_error_t) :: estimate
      type(intensity_t) :: corrected
      type(error_t), allocatable :: error
      real(rk), allocatable :: displacement(:, :), force(:, :, :)
      type(tip_probe_t) :: probe
      real(rk) :: moment(2)
      integer(ik) :: i
      real(rk) :: scale

      network = network_t(first=[1_ik, 3_ik], s_start=[0.0_rk], &
                          xy=reshape([-0.1_rk, 0.0_rk, 0.5_rk, 0.0_rk], [2, 2]))
      spec%x_min = 0.0_rk
      spec%x_max = 1.0_rk
      spec%y_min = -1.0_rk
      spec%y_max = 1.0_rk
      spec%size_fracture = 0.02_rk
      spec%size_boundary = 0.15_rk
      spec%is_window = .true.
      spec%rosette_sectors = 12
      spec%rosette_radius = 0.02_rk
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%no_error(error, "plate is meshed")
      mesh%xy = b*mesh%xy
      mesh%fracture%point_xy = b*mesh%fracture%point_xy
      mesh%fracture%cell_s = b*mesh%fracture%cell_s
      call model%set_mesh(mesh, elasticity_t(young_over*stress, poisson, 0.0_rk, &
                                             poisson < 0.4_rk), error, tip_element)
      call checks%no_error(error, "plate is numbered")
      boundary = free_boundary(model%mesh)
      loads = no_loads(model%mesh)
      select case (load)
      case (tension)
         call add_side_traction(model%mesh, 3_ik, [0.0_rk, -stress], loads%force)
         call add_side_traction(model%mesh, 4_ik, [0.0_rk, stress], loads%force)
      case (shear)
         call add_side_traction(model%mesh, 1_ik, [0.0_rk, -stress], loads%force)
         call add_side_traction(model%mesh, 2_ik, [0.0_rk, stress], loads%force)
         call add_side_traction(model%mesh, 3_ik, [-stress, 0.0_rk], loads%force)
         call add_side_traction(model%mesh, 4_ik, [stress, 0.0_rk], loads%force)
      case default
         call add_side_traction(model%mesh, 4_ik, [stress, 0.0_rk], loads%force)
      end select
      if (load == clamped) then
         call mark_side(model%mesh, 3_ik, 1_ik, boundary%prescribed)
         call mark_side(model%mesh, 3_ik, 2_ik, boundary%prescribed)
      else
         boundary%prescribed(:, nearest_node(model%mesh, [b, -b])) = .true.
         boundary%prescribed(1, nearest_node(model%mesh, [b, b])) = .true.
      end if
      call model%prepare(loaded_everywhere(model%mesh), error, boundary)
      call checks%no_error(error, "plate is held")
      call checks%is_true(model%constraints%n_dofs <= 5000, "at most 5000 unknowns")
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "plate is solved")
      call intensity_of_tip(model, loads, displacement, 1_ik, dimensionless, error)
      call checks%no_error(error, "plate has intensities")
      scale = stress*sqrt(0.5_rk*pi*b)
      dimensionless%k1 = dimensionless%k1/scale
      dimensionless%k2 = dimensionless%k2/scale
      dimensionless%k1_inner = dimensionless%k1_inner/scale
      dimensionless%k1_dc = dimensionless%k1_dc/scale
      dimensionless%k2_dc = dimensionless%k2_dc/scale
      dimensionless%g_domain = dimensionless%g_domain*model%elasticity%crack_modulus()/scale**2
      energy_over = model%strain_energy(displacement)*young_over/(stress*b**2)
      call recover_by_patches(model, displacement, recovery)
      call estimate_error(model, displacement, recovery, estimate)
      estimated = estimate%relative
      ! Without loads on the faces the intensities are the work of the extraction's forces.
      call probe_of_tip(model, 1_ik, probe, error)
      call checks%no_error(error, "the tip has a probe")
      force = probe%interactions%extraction_forces(model%mesh%n_nodes)
      call checks%is_close(sum(force(:, :, 1)*displacement)/scale, dimensionless%k1, 1.0e-9_rk, &
                           "K_I is linear in the displacement")
      call checks%is_close(sum(force(:, :, 2)*displacement)/scale, dimensionless%k2, 1.0e-9_rk, &
                           "K_II is linear in the displacement")
      ! A body that moves as a whole has none; so the forces are in balance.
      call checks%is_true(all(abs(sum(force, dim=2)) <= 1.0e-10_rk*sum(abs(force), dim=2)), &
                          "the extraction's forces are in balance")
      moment = [(sum(force(2, :, i)*model%mesh%xy(1, :) - force(1, :, i)*model%mesh%xy(2, :)), &
                 i=1, 2)]
      ! The auxiliary field is integrated to some 1e-5.
      call checks%is_true(all(abs(moment) <= 1.0e-4_rk*sum(hypot(force(1, :, :), force(2, :, :)) &
                                                         *spread(norm2(model%mesh%xy, 1), 2, 2))), &
                          "and so are their moments")
      call checks%is_true(has_dual(model), "faces that are loaded have a dual")
      call intensity_of_tip(model, loads, displacement, 1_ik, corrected, error)
      call correct_intensity(model, displacement, recovery, probe, corrected, error)
      call checks%no_error(error, "intensities are corrected")
      dimensionless%k1_corrected = corrected%k1_corrected/scale
      dimensionless%k2_corrected = corrected%k2_corrected/scale
      dimensionless%k1_error = corrected%k1_error/scale
      dimensionless%k2_error = corrected%k2_error/scale
   end subroutine solve

end program test_fine_tip_plate
